// MeshLab's projects (.mlp) and alignments (.aln): files of scans and their poses. docs/reference/formats.md.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

PointCloud read_mlp(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);
PointCloud read_aln(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);

}  // namespace soapfilm::io
