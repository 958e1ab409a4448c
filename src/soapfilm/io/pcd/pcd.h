// PCD, the Point Cloud Library's format, versions .5 to 0.7.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

void read_pcd(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context);

}  // namespace soapfilm::io
