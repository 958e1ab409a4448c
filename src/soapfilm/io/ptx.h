// Leica PTX: the range images of one or several scanner positions, as text.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

/// Does it begin like the head of a scan: two lines with a count each, four lines of 3 numbers, four lines of 4?
bool looks_like_ptx(const ByteSource& source);

PointCloud read_ptx(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);

}  // namespace soapfilm::io
