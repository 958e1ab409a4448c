// Judges a mesh in a file without the library's own judge of topology.
#pragma once

#include <string>

#include "soapfilm/mesh.h"

namespace soapfilm::test {

/// Reads a mesh that the program wrote: GLB here, other formats by read_mesh().
Mesh read_written(const std::string& path);

/// What is wrong with it; empty: nothing. Every triangle has an area, every vertex a triangle and finite coordinates,
/// every edge two triangles that agree on its direction (one where the surface may end), every vertex one fan, if
/// `one_fan`.
std::string broken_mesh_law(const Mesh& mesh, bool may_end, bool one_fan);

}  // namespace soapfilm::test
