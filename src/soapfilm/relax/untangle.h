// Undoes moves of a mesh's vertices that would fold it or make it intersect itself.
#pragma once

#include <span>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Halves, and in the end undoes completely, the moves from `start` (one place per vertex) of the corners of triangles
/// that have rotated by more than 66 degrees, and of pairs of triangles that meet elsewhere than in common corners and
/// edges, until only pairs that met before are left: for these, only `start` and the triangles matter. Edges are about
/// a voxel long.
void untangle(Mesh& mesh, std::span<const Vec3d> start, double voxel, const Context& context);

}  // namespace soapfilm
