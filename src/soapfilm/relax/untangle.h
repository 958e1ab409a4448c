// Moves of a mesh's vertices that would fold it or run it through itself, taken back.
#pragma once

#include <span>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Halves, and in the end takes back wholly, the moves from `start` (one place per vertex) of the corners of triangles
/// that have turned by more than 66 degrees, and of pairs of triangles that meet elsewhere than in common corners and
/// edges, until there are none but those that met before: `start` and the triangles alone decide about these. Edges are
/// about a voxel long.
void untangle(Mesh& mesh, std::span<const Vec3d> start, double voxel, const Context& context);

}  // namespace soapfilm
