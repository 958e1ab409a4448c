// Samples as lines of numbers (.xyz, .txt, .pts); docs/reference/formats.md has the table of columns.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/byte_source.h"

namespace soapfilm::io {

/// A line that holds one integer alone begins a scan of that many samples (as .pts files do).
PointCloud read_xyz(ByteSource& source, ReadReport& report, const Context& context);

}  // namespace soapfilm::io
