// The header of a PLY file (G. Turk, "The PLY polygon file format", 1994): the content and format of its body.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

enum class PlyFormat { ascii, binary_little_endian, binary_big_endian };

/// "PLY, ASCII" and so on, for reports.
const char* describe(PlyFormat format);

enum class PlyType : uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

inline size_t size_of(PlyType type) {
  constexpr std::array<size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<size_t>(type)];
}
inline bool is_integer(PlyType type) { return type < PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  ///< set for a list; an integer type

  bool is_list() const { return count_type.has_value(); }
};

struct PlyElement {
  static constexpr size_t absent = SIZE_MAX;

  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
  size_t line = 0;  ///< of the header, for messages

  /// Index of a scalar property, or `absent`.
  size_t find_scalar(std::string_view property) const;
  /// Index of a list property, or `absent`.
  size_t find_list(std::string_view property) const;
  /// The smallest number of bytes of a row.
  size_t least_row_bytes(PlyFormat format) const;
};

/// A `comment` or `obj_info` line without its keyword.
struct PlyNote {
  std::string text;
  size_t line = 0;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<PlyNote> notes;
  std::vector<PlyNote> stray;  ///< lines without a keyword
  char line_end = '\n';        ///< or '\r'
  size_t body_offset = 0;
  size_t body_line = 0;

  const PlyElement* find(std::string_view element) const;
};

void warn_of_stray_lines(const PlyHeader& header, const std::string& path, ReadReport& report);

/// Does it begin with a line `ply`? (Blanks may follow; lines may end with LF, CRLF or CR.)
bool looks_like_ply(const ByteSource& source);

/// Throws InputError "file:line: ..." for a header that breaks the format's rules.
PlyHeader read_ply_header(ByteSource& source);

}  // namespace soapfilm::io
