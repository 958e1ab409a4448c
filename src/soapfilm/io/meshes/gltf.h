// Meshes as binary glTF 2.0 (.glb), for viewers and the web.
#pragma once

#include "soapfilm/io.h"

namespace soapfilm::io {

/// glTF has 32-bit coordinates: they are relative to the center of the mesh's box, which is the node's translation (in
/// double). Axes stay as they are. Colors are COLOR_0, attributes _NAME.
WriteReport write_glb(const std::string& path, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
