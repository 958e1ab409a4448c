// Removes parts of a closed mesh; the rest has a boundary where they were.
#pragma once

#include <functional>

#include "soapfilm/mesh.h"

namespace soapfilm {

/// Keeps the triangles whose three vertices are wanted, by index. The rest of a closed manifold mesh is a manifold with
/// boundary: where fans of triangles would only meet in one vertex, each gets its own, at the same place. Unused
/// vertices are removed; the order stays. Normals, colors and attributes are dropped.
void keep_triangles(Mesh& mesh, const std::function<bool(uint32_t)>& wanted);

}  // namespace soapfilm
