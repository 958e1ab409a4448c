// Reads LAS and LAZ files (ASPRS, versions 1.0 to 1.4); docs/reference/formats.md describes what is read.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

bool looks_like_las(const ByteSource& source);

/// With a trajectory each sample gets the scanner's position at its GPS time.
void read_las(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context);

}  // namespace soapfilm::io
