// Colors and columns of the samples, carried to the vertices of the mesh.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// In the order of the grid's samples; empty where there are none.
struct SampleAttributes {
  std::vector<Rgb8> colors;
  std::vector<Column> columns;

  bool empty() const { return colors.empty() && columns.empty(); }
};

/// Throws ParameterError for a name that is neither "all", "color" nor that of a column.
void check_attributes(const PointCloud& cloud, std::span<const std::string> names);

/// Those of the cloud that are named: "color", columns, or "all". `samples` know their places in the cloud.
SampleAttributes sort_attributes(const PointCloud& cloud, const GridSamples& samples,
                                 std::span<const std::string> names);

/// Each vertex gets the mean over the samples within attribute_reach of it, by their weights and nearness; labels the
/// value with most weight. Where no sample is so near, the nearest one's. Values that are not a number do not count.
void carry_attributes(const SampleAttributes& attributes, const GridSamples& samples, const Lattice& lattice,
                      const Context& context, Mesh& mesh);

inline constexpr double attribute_reach = 1.5;  ///< voxels

}  // namespace soapfilm
