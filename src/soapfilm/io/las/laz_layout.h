// How the points of a LAZ file are compressed, by its record of LASzip, and where its chunks are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/las/las_header.h"

namespace soapfilm::io {

/// Points that are decoded without those before them.
struct LazChunk {
  uint64_t begin = 0;  ///< in the file
  uint64_t bytes = 0;
  uint64_t first = 0;  ///< of the file's points
  uint64_t points = 0;
};

struct LazLayout {
  size_t points_offset = 0;  ///< what lies before says what the points are
  int point_format = 0;
  size_t record_bytes = 0;
  size_t extra_bytes = 0;  ///< of a record, at its end
  bool layered = false;    ///< each field of a chunk in a stream of its own: formats 6 to 10
  int version = 2;         ///< of the items: 1, 2; layered 3, 4
  std::vector<LazChunk> chunks;
};

/// `record`: the content of the file's record of LASzip. Throws InputError for what is not known here, and for chunks
/// that are not in the file or hold other points than the header counts.
LazLayout read_laz_layout(ByteSource& source, const LasHeader& header, std::string_view record);

}  // namespace soapfilm::io
