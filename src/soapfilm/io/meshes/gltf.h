// Meshes as binary glTF 2.0 (.glb), for viewers and the web.
#pragma once

#include "soapfilm/io.h"

namespace soapfilm::io {

/// glTF has 32-bit coordinates: they are relative to the center of the mesh's box, which is the node's translation (in
/// double). A node above it turns WriteOptions::up to y (gltf_up.h). Normals, the faces' where the mesh has none, are
/// NORMAL, colors COLOR_0, attributes _NAME; the one material is seen from both sides where the mesh is open.
WriteReport write_glb(const std::string& path, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
