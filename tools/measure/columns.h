// The volumes between two meshes, by vertical columns: what was added and what was taken away.
#pragma once

#include <cstddef>
#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"
#include "tools/measure/above_plane.h"

namespace soapfilm {

struct ColumnOptions {
  double cell = 0;  ///< edge of a column, input units, >= 0; 0: a million columns over both meshes
  std::optional<Window> window{};
};

/// A volume and how far its two halves, the columns of either color of a checkerboard, are apart: about its error.
struct Estimated {
  double value = 0;
  double error = 0;
};

struct VolumesBetween {
  double cell = 0;  ///< used
  size_t columns = 0;
  Estimated fill;                ///< in the mesh and not in the other one: added, above it
  std::optional<Estimated> cut;  ///< in the other one and not in the mesh; none of a solid that stands on a sheet
  Estimated net;                 ///< fill - cut; of the columns that count, without a cut that of the fill alone
  double footprint = 0;  ///< area of the columns that count: those with both meshes, and of two closed ones with either
  double left_out = 0;   ///< of those with one mesh alone, where an open one has no ground
};

/// Solid is what a closed mesh encloses, and what lies below an open one, whose faces are turned up if they mostly look
/// down. Along each column the parts inside of one and outside of the other are exact; how finely the columns lie
/// decides the error. Overhangs count as what they are. z is up. The result is the same for any number of threads.
///
/// Throws ParameterError for a cell so small that there are more than 1e9 columns, a mesh without triangles, and an
/// open mesh beside a closed `other`.
VolumesBetween volumes_between(const Mesh& mesh, const Mesh& other, const ColumnOptions& options,
                               const Context& context);

}  // namespace soapfilm
