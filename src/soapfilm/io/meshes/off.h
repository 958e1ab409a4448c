// Object File Format meshes (Geomview): OFF with the vertex prefixes ST, C and N, as text.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

/// Does the head count faces?
bool off_has_faces(ByteSource& source);
/// The vertices as samples; of clouds there are no faces.
PointCloud read_off_points(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);
Mesh read_off(ByteSource& source, ReadReport& report);

/// Normals (NOFF) and colors (COFF) come along, attributes are left out with a warning.
WriteReport write_off(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
