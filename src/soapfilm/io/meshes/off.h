// Object File Format meshes (Geomview): OFF with the vertex prefixes ST, C and N, as text.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

Mesh read_off(ByteSource& source, ReadReport& report);

/// Normals (NOFF) and colors (COFF) come along, attributes are left out with a warning.
WriteReport write_off(const std::string& path, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
