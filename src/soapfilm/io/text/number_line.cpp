#include "soapfilm/io/text/number_line.h"

#include <fmt/format.h>

#include <algorithm>

namespace soapfilm::io {

size_t parse_number_line(const TextCursor& cursor, std::string_view line, std::span<double> values) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (size_t count = 0;; ++count) {
    while (at != end && is_blank(*at)) ++at;
    if (at == end) return count;
    if (count == values.size())
      cursor.fail(fmt::format("more than {} number{}", values.size(), values.size() == 1 ? "" : "s"));
    if (const char* after = parse_usual_number(at, end, values[count])) {
      at = after;
      continue;
    }
    const char* const begin = at;
    while (at != end && !is_blank(*at)) ++at;
    const std::string_view token(begin, static_cast<size_t>(at - begin));
    if (!parse_number(token, values[count]))
      cursor.fail(fmt::format("column {} = {}, must be a number", count + 1, in_quotes(token)));
  }
}

std::string_view without_commas(std::string_view line, size_t count, std::string& buffer) {
  if (line.find(',') == std::string_view::npos) return line;
  size_t words = 0, decimal = 0;
  std::string_view rest = line;
  for (std::string_view word; next_field(rest, word); ++words)
    decimal += word.find(',') != std::string_view::npos && word.back() != ',';
  buffer = line;
  std::replace(buffer.begin(), buffer.end(), ',', words == count && decimal > 0 ? '.' : ' ');
  return buffer;
}

bool next_filled_line(TextCursor& cursor, std::string_view& line) {
  while (cursor.next_line(line))
    for (const char c : line)
      if (!is_blank(c)) return true;
  return false;
}

}  // namespace soapfilm::io
