// Samples as lines of numbers (.xyz, .txt, .pts); docs/reference/formats.md has the table of columns.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/byte_source.h"

namespace soapfilm::io {

/// A line with a single integer begins a scan of that many samples (as in .pts files).
PointCloud read_xyz(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);

}  // namespace soapfilm::io
