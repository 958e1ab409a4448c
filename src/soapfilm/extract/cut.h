// Parts of a closed mesh taken away: what is left ends where they were.
#pragma once

#include <functional>

#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Keeps the triangles whose three vertices are wanted, by index. What is left of a closed manifold mesh is a manifold
/// with boundary: where fans of triangles would meet in one vertex alone each gets its own, at the same place. Without
/// unused vertices; the order stays. Normals, colors and attributes are dropped.
void keep_triangles(Mesh& mesh, const std::function<bool(uint32_t)>& wanted);

/// Takes away what closes the mesh along the border of an open lattice: a voxel of it.
void cut_at_border(Mesh& mesh, const Lattice& lattice);

}  // namespace soapfilm
