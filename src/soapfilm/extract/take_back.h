// Moves of a mesh's vertices that would fold it or run it through itself, taken back.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/core/mesh.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// Halves, and in the end takes back wholly, the moves from `start` (one place per vertex) of the corners of triangles
/// that have turned by more than 66 degrees, and of pairs of triangles that meet elsewhere than in common corners and
/// edges, until there are none. Edges are about a voxel long.
///
/// Returns the vertices, ascending, of pairs that meet although no corner of theirs moves: those were there before.
std::vector<uint32_t> take_back(Mesh& mesh, std::span<const Vec3d> start, const Lattice& lattice,
                                const Parallel& parallel);

}  // namespace soapfilm
