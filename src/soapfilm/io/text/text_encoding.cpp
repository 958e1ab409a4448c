#include "soapfilm/io/text/text_encoding.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr std::string_view utf16_little_mark = "\xFF\xFE", utf16_big_mark = "\xFE\xFF";

/// The byte order of UTF-16, known by its mark or, for numbers and Latin letters, by a zero in every second byte.
std::optional<std::endian> utf16_order(std::string_view bytes) {
  if (bytes.substr(0, 2) == utf16_little_mark) return std::endian::little;
  if (bytes.substr(0, 2) == utf16_big_mark) return std::endian::big;
  constexpr size_t looked_at = 512;
  const size_t size = std::min(bytes.size(), looked_at) / 2 * 2;
  size_t zeros[2] = {0, 0};
  for (size_t i = 0; i < size; ++i) zeros[i % 2] += bytes[i] == '\0';
  if (size < 4 || zeros[0] + zeros[1] != size / 2) return std::nullopt;
  if (zeros[0] == 0) return std::endian::little;
  if (zeros[1] == 0) return std::endian::big;
  return std::nullopt;
}

std::string utf8_of(std::string_view bytes, std::endian order) {
  const bool swap = order != std::endian::native;
  std::string text;
  text.reserve(bytes.size() / 2);
  const bool marked = bytes.substr(0, 2) == utf16_little_mark || bytes.substr(0, 2) == utf16_big_mark;
  for (size_t i = marked ? 2 : 0; i + 1 < bytes.size(); i += 2) {
    const unsigned code = load<uint16_t>(bytes.data() + i, swap);
    if (code < 0x80) {
      text += static_cast<char>(code);
    } else if (code < 0x800) {
      text += static_cast<char>(0xC0 | code >> 6);
      text += static_cast<char>(0x80 | (code & 0x3F));
    } else if (code >= 0xD800 && code < 0xE000) {  // half of a rare character: no name of a column has one
      text += '?';
    } else {
      text += static_cast<char>(0xE0 | code >> 12);
      text += static_cast<char>(0x80 | (code >> 6 & 0x3F));
      text += static_cast<char>(0x80 | (code & 0x3F));
    }
  }
  return text;
}

void check_is_text(std::string_view text, const std::string& path) {
  constexpr size_t looked_at = size_t{1} << 16;
  for (size_t i = 0; i < std::min(text.size(), looked_at); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < ' ' && !is_blank(text[i]))
      throw InputError(fmt::format("{}: byte {}: 0x{:02x}, must be text: lines of numbers", path, i, c));
  }
}

}  // namespace

std::optional<std::string> utf8_of_utf16(std::string_view bytes) {
  const std::optional<std::endian> order = utf16_order(bytes);
  if (!order) return std::nullopt;
  return utf8_of(bytes, *order);
}

PlainText::PlainText(ByteSource& source) : source_(source), text_(after_byte_order_mark(source.bytes())) {
  if (std::optional<std::string> converted = utf8_of_utf16(source.bytes())) {
    converted_ = std::move(*converted);
    text_ = converted_;
  }
  constexpr char end_of_file = 0x1A;  // of DOS programs
  while (!text_.empty() && text_.back() == end_of_file) text_.remove_suffix(1);
  check_is_text(text_, source.path());
}

void PlainText::release_before(size_t offset) {
  const size_t size = source_.bytes().size();
  if (converted_.empty())
    source_.release_before(offset + static_cast<size_t>(text_.data() - source_.bytes().data()));
  else
    source_.release_before(std::min(2 * offset, size));
}

}  // namespace soapfilm::io
