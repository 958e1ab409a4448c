// How well the samples support each vertex of a mesh: what is trimmed.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// One value per vertex: 1 on the line along which the mesh is cut, more where it is made up. Smoothed a little along
/// the mesh, so that cuts do not follow single samples; vertices below 1 before that stay so.
struct TrimLevels {
  std::vector<double> level;
  std::vector<uint8_t> unfaced;  ///< the nearest samples look to the other side; empty: not asked for
  static constexpr uint32_t none = ~uint32_t{0};
  std::vector<uint32_t> nearest;  ///< sample, or none within the distance; empty: not asked for
};

/// A vertex is made up where no sample is nearer than `distance`, input units; and, if `facing`, where the nearest six
/// samples within that distance or 3 of their own spacings look to the other side of the surface, weighted by how much.
/// Does not depend on the number of threads.
TrimLevels find_trim_levels(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, double distance,
                            bool facing, const Context& context);

}  // namespace soapfilm
