#include "soapfilm/io/meshes/obj_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "soapfilm/io/text/text_encoding.h"

namespace soapfilm::io {

namespace {

/// Converts from 1 upwards, or from -1 (the last one so far) downwards, to from 0 upwards.
uint32_t parse_obj_index(const TextCursor& cursor, std::string_view text, size_t so_far) {
  int64_t index = 0;
  if (!parse_integer(text, index)) cursor.fail("index " + in_quotes(text) + ", must be an integer");
  if (index <= 0 && (index == 0 || index < -static_cast<int64_t>(so_far)))
    cursor.fail(fmt::format("index {}, must be from 1 up or from -1 down to -{}", index, so_far));
  const int64_t from_zero = index > 0 ? index - 1 : static_cast<int64_t>(so_far) + index;
  if (from_zero > INT32_MAX) cursor.fail(fmt::format("index {}, must be at most {}", index, INT32_MAX));
  return static_cast<uint32_t>(from_zero);
}

/// Where the line that begins at `begin` ends: at its LF, or at the end of the text.
size_t end_of_obj_line(std::string_view text, size_t begin) { return std::min(text.find('\n', begin), text.size()); }

/// The place of the '\\' that ends the line, before blanks; none for comments.
std::optional<size_t> continuation_of(std::string_view text, size_t begin, size_t end) {
  while (begin < end && is_blank(text[begin])) ++begin;
  while (end > begin && is_blank(text[end - 1])) --end;
  if (begin == end || text[begin] == '#' || text[end - 1] != '\\') return std::nullopt;
  return end - 1;
}

bool has_continuations(std::string_view text) {
  for (size_t at = text.find('\\'); at != std::string_view::npos; at = text.find('\\', at + 1)) {
    size_t end = at + 1;
    while (end < text.size() && text[end] != '\n' && is_blank(text[end])) ++end;
    if (end < text.size() && text[end] == '\n') return true;
  }
  return false;
}

std::string with_joined_lines(std::string_view text) {
  std::string joined;
  joined.reserve(text.size());
  size_t waiting = 0;  // ends of lines
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = end_of_obj_line(text, begin);
    const std::optional<size_t> slash = continuation_of(text, begin, end);
    joined += text.substr(begin, slash.value_or(end) - begin);
    waiting += end < text.size();
    if (slash)
      joined += ' ';
    else
      joined.append(std::exchange(waiting, 0), '\n');
    begin = end + 1;
  }
  return joined;
}

}  // namespace

ObjSource::ObjSource(ByteSource& source) : source_(source) {
  if (std::optional<std::string> converted = utf8_of_utf16(source.bytes())) text_ = std::move(*converted);
  const std::string_view text = text_.empty() ? source.bytes() : std::string_view(text_);
  if (has_continuations(text)) text_ = with_joined_lines(text);
  if (!text_.empty()) plain_.emplace(source.path(), text_);
}

ObjCorner parse_obj_corner(const TextCursor& cursor, std::string_view field, size_t vertices_so_far,
                           size_t normals_so_far) {
  const size_t slash = field.find('/');
  ObjCorner corner{parse_obj_index(cursor, field.substr(0, slash), vertices_so_far), {}};
  const size_t second = slash == std::string_view::npos ? slash : field.find('/', slash + 1);
  if (second != std::string_view::npos && second + 1 < field.size())
    corner.normal = parse_obj_index(cursor, field.substr(second + 1), normals_so_far);
  return corner;
}

}  // namespace soapfilm::io
