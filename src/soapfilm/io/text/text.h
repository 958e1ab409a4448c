// Text input for the readers: lines, fields and numbers, with the line number for messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

/// UTF-8 without control characters beyond ASCII?
bool is_utf8_text(std::string_view text);

/// `token` in quotes for a message: unprintable bytes as '?', cut after 40 bytes or a few less.
std::string in_quotes(std::string_view token);

std::string lower_case(std::string_view text);

/// A number as the C locale writes it, also with a leading '+', "nan", "inf" and Microsoft's "1.#IND", "1.#QNAN",
/// "1.#INF"; true when the whole token is one. Beyond the range of double: infinity or zero.
bool parse_number(std::string_view token, double& value);

/// The number at `at`, if it is followed by a blank, `separator` or `end` and has the usual spelling; returns where it
/// ends. Null for any other text, which may still be a number for parse_number().
const char* parse_usual_number(const char* at, const char* end, double& value, char separator = ' ');

/// A decimal integer; true when the whole token is one that fits.
bool parse_integer(std::string_view token, int64_t& value);

inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Splits the next field off `line`; false when only blanks are left.
inline bool next_field(std::string_view& line, std::string_view& field) {
  size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  field = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return !field.empty();
}

/// The text after a UTF-8 byte order mark, as editors on Windows write it at the beginning, or all of it.
inline std::string_view after_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.substr(text.substr(0, mark.size()) == mark ? mark.size() : 0);
}

/// Reads text in order, after any byte order mark. Lines end with LF or CRLF, or with CR if end_lines_with() says so,
/// and are counted from 1.
class TextCursor {
 public:
  explicit TextCursor(ByteSource& source, size_t offset = 0, size_t line = 1)
      : source_(source),
        at_(source.bytes().data() + offset),
        end_(source.bytes().data() + source.bytes().size()),
        line_(line) {
    if (offset == 0) at_ = end_ - after_byte_order_mark(source.bytes()).size();
  }

  /// '\n', or '\r' for text with bare CR (no LF belongs to its line ends).
  void end_lines_with(char end) { line_end_ = end; }

  size_t offset() const { return static_cast<size_t>(at_ - source_.bytes().data()); }
  size_t remaining() const { return static_cast<size_t>(end_ - at_); }

  /// The number of the line that the last call read from.
  size_t line() const { return line_; }

  /// The next line without its end; false at the end of the file.
  bool next_line(std::string_view& line);

  /// As next_line(), but skips lines that are blank or begin with '#'.
  bool next_content_line(std::string_view& line);

  /// The next token, on this line or a later one; empty at the end of the file.
  std::string_view token();

  /// The next token, which must be a number; `what` names it in the message.
  double number(std::string_view what);

  /// The next token if it is a whole number of few digits, as counts and indices are; else none, and the token is not
  /// consumed.
  std::optional<uint32_t> small_count() {
    constexpr int most_digits = 9;
    skip_blanks();
    const char* at = at_;
    uint32_t value = 0;
    for (; at != end_ && at - at_ <= most_digits && *at >= '0' && *at <= '9'; ++at)
      value = 10 * value + static_cast<uint32_t>(*at - '0');
    if (at == at_ || at - at_ > most_digits || (at != end_ && !is_blank(*at))) return std::nullopt;
    at_ = at;
    return value;
  }

  void release() { source_.release_before(offset()); }

  /// Skips blanks and ends of lines.
  void skip_blanks() {
    if (next_line_ != 0) {  // next_line() has passed the end of a line but counts it only when the next line begins
      line_ = next_line_;
      next_line_ = 0;
    }
    for (; at_ != end_ && is_blank(*at_); ++at_) line_ += *at_ == line_end_;
  }
  /// Continues at `offset`, which is on the given line.
  void jump(size_t offset, size_t line) {
    at_ = source_.bytes().data() + offset;
    line_ = line;
    next_line_ = 0;
  }

  /// Throws InputError "file:line: message".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  ByteSource& source_;
  const char* at_;
  const char* end_;
  size_t line_;
  char line_end_ = '\n';
  size_t next_line_ = 0;  // number of the line that next_line() reads next; 0 before its first call
};

}  // namespace soapfilm::io
