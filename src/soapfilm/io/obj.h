// Wavefront OBJ meshes: v, vn and f lines; all others are ignored.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/byte_source.h"

namespace soapfilm::io {

Mesh read_obj(ByteSource& source);
WriteReport write_obj(const std::string& path, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
