// Reads NumPy arrays (.npy) as samples; docs/reference/formats.md describes what is read.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

bool looks_like_npy(const ByteSource& source);

/// A row of numbers, or of named fields, for each sample.
void read_npy(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context);

}  // namespace soapfilm::io
