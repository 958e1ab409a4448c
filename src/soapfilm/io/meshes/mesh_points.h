// The vertices of a mesh as samples.
#pragma once

#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/mesh.h"

namespace soapfilm::io {

/// A cloud of one scan. Without normals of their own the vertices have those of the triangles, if there are some; of
/// normals that only some vertices have, the others have none.
PointCloud points_of_mesh(Mesh&& mesh, const ByteSource& source, std::string format, bool float32, ReadReport& report);

}  // namespace soapfilm::io
