// Reads and writes PLY files; docs/reference/formats.md describes what is read and written.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

/// The vertices as samples, with range grids and scans; other elements are ignored.
void read_ply_points(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
                     const Context& context);

/// Vertices and faces (or triangle strips); scalar properties without a known meaning become attributes.
Mesh read_ply_mesh(ByteSource& source, ReadReport& report);

/// True when the header declares faces or triangle strips.
bool ply_has_faces(ByteSource& source);

WriteReport write_ply_mesh(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context);
WriteReport write_ply_points(AtomicFile& file, const PointCloud& cloud, const WriteOptions& options,
                             const Context& context);

}  // namespace soapfilm::io
