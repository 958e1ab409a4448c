// Samples as lines of numbers (.xyz, .txt, .csv, .pts, ...); docs/reference/formats.md says what the columns mean.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

/// The columns mean what options.columns, a header line, the extension or, last, their values say. Throws
/// ParameterError for options.columns without x, y and z or with a name twice.
void read_text_points(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
                      const Context& context);

}  // namespace soapfilm::io
