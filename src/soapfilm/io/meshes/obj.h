// Wavefront OBJ, as meshes or clouds: v, vn and f lines; all others are ignored.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

Mesh read_obj(ByteSource& source, ReadReport& report);

/// The vertices as samples. Normals: of `vn` lines that correspond to the vertices one to one, else of the faces.
PointCloud read_obj_points(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);

/// Is there an `f` line? Reads on until there is one.
bool obj_has_faces(ByteSource& source);

WriteReport write_obj(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
