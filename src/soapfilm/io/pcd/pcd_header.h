// The header of a PCD file: what a point holds, how many there are, and how they are coded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

enum class PcdData { ascii, binary, compressed };

/// "PCD, ASCII" and so on, for reports.
const char* describe(PcdData data);

struct PcdField {
  std::string name;
  char type = 'F';         ///< I, U or F
  uint64_t size = 4;       ///< bytes of one value
  uint64_t count = 1;      ///< values of a point
  size_t offset = 0;       ///< of its first value among a point's bytes
  size_t first_value = 0;  ///< and among a point's values

  bool is_padding() const { return name == "_"; }
  uint64_t bytes() const { return size * count; }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  size_t point_bytes = 0;
  size_t point_values = 0;
  uint64_t columns = 0;  ///< of the range image, if it has several rows
  uint64_t rows = 1;
  uint64_t points = 0;
  size_t points_line = 0;                                ///< for messages
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0};  ///< translation, then the quaternion w x y z
  PcdData data = PcdData::ascii;
  size_t body_offset = 0;
  size_t body_line = 0;
};

/// By a comment `# .PCD` or the first keywords.
bool looks_like_pcd(const ByteSource& source);

/// Throws InputError for a header that contradicts itself, or that promises more than the rest of the file can hold
/// (of compressed data only the reader can tell). Warns of keywords that are not known.
PcdHeader read_pcd_header(ByteSource& source, ReadReport& report);

}  // namespace soapfilm::io
