// glTF 2.0 in one file (.glb): the points and triangles of its scene.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

bool looks_like_glb(const ByteSource& source);

/// Does a mesh of the file have triangles?
bool glb_has_faces(ByteSource& source);

/// All vertices of points and triangles, moved by their nodes.
PointCloud read_glb_points(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);
Mesh read_glb_mesh(ByteSource& source, ReadReport& report);

}  // namespace soapfilm::io
