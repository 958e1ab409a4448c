// The variable length records of a LAS file: its coordinate system, and what extra bytes of its points mean.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/io/bytes/binary_fields.h"
#include "soapfilm/io/las/las_header.h"

namespace soapfilm::io {

struct LasRecords {
  std::string coordinate_system;   ///< WKT, "EPSG:NUMBER" or empty
  std::vector<BinaryField> extra;  ///< described fields; offsets count from the extra bytes' beginning
  size_t extra_bytes = 0;          ///< that records describe, at most `room`
  size_t undescribed_bytes = 0;    ///< of `room`
  std::string_view laszip;         ///< how the points are compressed; empty: no record says it
  std::string_view copc;           ///< the octree of a COPC file; empty: it is none
};

/// `room`: the extra bytes of each point. Records that lie, or are not in the file, are warned of and left out.
LasRecords read_las_records(ByteSource& source, const LasHeader& header, size_t room, ReadReport& report);

}  // namespace soapfilm::io
