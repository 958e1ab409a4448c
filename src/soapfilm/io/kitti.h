// Reads sweeps of a turning scanner as the KITTI and nuScenes data sets store them: rows of 32-bit numbers, no header.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

/// x y z intensity, or (nuScenes) x y z intensity ring; the scanner stands at the origin. Throws InputError for bytes
/// that cannot be such a sweep: files of many kinds end with .bin.
void read_kitti(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
                const Context& context);

}  // namespace soapfilm::io
