// The public header block of a LAS file (ASPRS, versions 1.0 to 1.4).
#pragma once

#include <cstddef>
#include <cstdint>

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/vec.h"

namespace soapfilm::io {

struct LasHeader {
  int minor_version = 0;
  bool adjusted_gps_time = false;  ///< GPS times are seconds since 1980 less 1e9; else seconds of the GPS week
  size_t header_bytes = 0;
  size_t points_offset = 0;
  int point_format = 0;
  bool compressed = false;  ///< LAZ
  size_t record_bytes = 0;
  uint64_t count = 0;  ///< of points; unless compressed, their records are in the file
  Vec3d scale;
  Vec3d offset;
  Box3d box;                      ///< as the file says; it may be wrong, or zero
  uint32_t variable_records = 0;  ///< between header and points
  uint32_t extended_records = 0;  ///< of 1.4, after the points
  uint64_t extended_offset = 0;   ///< where they begin; it may be wrong
  uint64_t waveform_offset = 0;   ///< of 1.3 and 1.4, after the points; it may be wrong
  /// Where other records may begin; compressed points end after that.
  size_t end_of_points() const { return points_offset + (compressed ? 0 : static_cast<size_t>(count) * record_bytes); }
  bool has_waveforms() const { return point_format == 4 || point_format == 5 || point_format >= 9; }
};

/// Bytes of the fields that the standard gives a record of this format; what a record has beyond is extra bytes.
size_t standard_bytes(int point_format);

/// Throws InputError for a file that ends before its last point, unless it is compressed (LAZ).
LasHeader read_las_header(ByteSource& source, ReadReport& report);

}  // namespace soapfilm::io
