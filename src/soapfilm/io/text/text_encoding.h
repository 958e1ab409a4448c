// Bytes of a file as text: byte order marks, UTF-16, and files that are no text.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

/// The UTF-8 of a text in UTF-16; none for other bytes.
std::optional<std::string> utf8_of_utf16(std::string_view bytes);

/// The text of a file without its byte order mark; UTF-16 becomes UTF-8. Throws InputError if the first bytes are not
/// text.
class PlainText {
 public:
  explicit PlainText(ByteSource& source);
  PlainText(const PlainText&) = delete;
  PlainText& operator=(const PlainText&) = delete;

  std::string_view text() const { return text_; }
  /// The reader has passed `offset` of the text.
  void release_before(size_t offset);

 private:
  ByteSource& source_;
  std::string converted_;  // of a UTF-16 file
  std::string_view text_;
};

}  // namespace soapfilm::io
