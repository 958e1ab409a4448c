// STL meshes, binary and text. A file holds loose triangles: corners with the same coordinates become one vertex.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

Mesh read_stl(ByteSource& source, ReadReport& report);

/// Warns when float coordinates, the only ones of the format, lose more precision than the options allow.
WriteReport write_stl(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
