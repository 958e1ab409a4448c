// E57 (ASTM E2807): scans in binary, with XML that says what they hold. Conventions: docs/reference/formats.md.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

bool looks_like_e57(const ByteSource& source);
void read_e57(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context);

}  // namespace soapfilm::io
