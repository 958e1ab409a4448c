// Where the certificate's gap is: how much of it lies around each vertex of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

inline constexpr double gap_reach = 2;  ///< voxels

/// The gap of a solution at the vertices of its band, and the vertices beside its surface.
struct GapField {
  BrickGrid grid;
  Field<float> gap;  ///< in units of lambda
  std::vector<BrickBits> beside;
};

/// Its memory, with the vertices beside the surface twice while they are found.
constexpr uint64_t gap_bytes(uint64_t bricks) {
  return (brick_volume * sizeof(float) + 2 * sizeof(BrickBits) + sizeof(Vec3i) + sizeof(BrickGrid::Neighbors)) * bricks;
}

/// Per vertex of the mesh: the gap of the lattice's vertices that are less than gap_reach away along each axis,
/// weighted by a tent, over the area of a plane under the same tent: 0.01 is a hundredth of the price of the area
/// there. Not a number where the solution's surface is not within reach: the mesh has left it. Only the sum over the
/// whole surface bounds how much a better one could save.
std::vector<float> vertex_gap(const Mesh& mesh, const GapField& field, const Lattice& lattice, const Context& context);

}  // namespace soapfilm
