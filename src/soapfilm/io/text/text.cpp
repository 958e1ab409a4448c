#include "soapfilm/io/text/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "soapfilm/core/number_text.h"
#include "soapfilm/error.h"

namespace soapfilm::io {

bool is_utf8_text(std::string_view text) {
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    const int more = lead >= 0xF0 && lead < 0xF5   ? 3
                     : lead >= 0xE0 && lead < 0xF0 ? 2
                     : lead >= 0xC2 && lead < 0xE0 ? 1
                                                   : 0;
    if (more == 0) return false;
    uint32_t code = lead & (0x3Fu >> more);
    for (int k = 0; k < more; ++k, ++i) {
      if (i >= text.size() || (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) return false;
      code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3Fu);
    }
    const uint32_t least = more == 1 ? 0xA0 : more == 2 ? 0x800 : 0x10000;
    if (code < least || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) return false;
  }
  return true;
}

std::string in_quotes(std::string_view token) {
  constexpr size_t longest = 40;
  const auto goes_on = [&](size_t at) { return (static_cast<unsigned char>(token[at]) & 0xC0) == 0x80; };
  size_t end = std::min(token.size(), longest);
  const bool is_utf8 = is_utf8_text(token);
  while (is_utf8 && end > 0 && end < token.size() && goes_on(end)) --end;
  std::string text = "'";
  for (const char c : token.substr(0, end))
    text += (c >= ' ' && c <= '~') || (is_utf8 && static_cast<unsigned char>(c) >= 0x80) ? c : '?';
  return text + (token.size() > longest ? "...'" : "'");
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

namespace {

/// from_chars() does not report whether an out-of-range number is too large or too small: small ones have a negative
/// exponent or start with "0." or ".".
double out_of_range_value(std::string_view token) {
  const bool negative = token.front() == '-';
  if (negative) token.remove_prefix(1);
  const size_t exponent = token.find_first_of("eE");
  const bool small = exponent != std::string_view::npos ? token.substr(exponent + 1, 1) == "-"
                                                        : token.front() == '0' || token.front() == '.';
  const double value = small ? 0.0 : std::numeric_limits<double>::infinity();
  return negative ? -value : value;
}

}  // namespace

bool parse_number(std::string_view token, double& value) {
  if (!token.empty() && token.front() == '+') {
    token.remove_prefix(1);
    if (!token.empty() && (token.front() == '-' || token.front() == '+')) return false;
  }
  if (token.empty()) return false;
  const char* end = token.data() + token.size();
  const NumberEnd parsed = number_from_text(token.data(), end, value);
  if (parsed.ec == std::errc::result_out_of_range && parsed.ptr == end) {
    value = out_of_range_value(token);
    return true;
  }
  if (parsed.ec != std::errc{}) return false;
  if (parsed.ptr == end) return true;
  const std::string_view rest(parsed.ptr, static_cast<size_t>(end - parsed.ptr));
  if (rest != "#IND" && rest != "#QNAN" && rest != "#SNAN" && rest != "#INF") return false;
  value = std::numeric_limits<double>::quiet_NaN();
  return true;
}

bool parse_integer(std::string_view token, int64_t& value) {
  const char* end = token.data() + token.size();
  const std::from_chars_result parsed = std::from_chars(token.data(), end, value);
  return parsed.ec == std::errc{} && parsed.ptr == end;
}

bool TextCursor::next_line(std::string_view& line) {
  if (at_ == end_) return false;
  line_ = next_line_ == 0 ? line_ : next_line_;
  next_line_ = line_ + 1;
  const void* found = std::memchr(at_, line_end_, remaining());
  const char* line_end = found != nullptr ? static_cast<const char*>(found) : end_;
  line = {at_, static_cast<size_t>(line_end - at_)};
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  at_ = found != nullptr ? line_end + 1 : end_;
  return true;
}

bool TextCursor::next_content_line(std::string_view& line) {
  while (next_line(line)) {
    size_t begin = 0;
    while (begin < line.size() && is_blank(line[begin])) ++begin;
    if (begin < line.size() && line[begin] != '#') return true;
  }
  return false;
}

std::string_view TextCursor::token() {
  skip_blanks();
  const char* begin = at_;
  while (at_ != end_ && !is_blank(*at_)) ++at_;
  return {begin, static_cast<size_t>(at_ - begin)};
}

namespace {

/// Numbers as most files have them: [-]digits[.digits][e[+-]digits] with a mantissa up to 2^53 and a power of ten up to
/// 22. Both are exact in double, so one operation rounds correctly (Clinger 1990, "How to read floating point numbers
/// accurately"). Returns where the number ends; null for anything else, which is left to from_chars().
const char* parse_plain_number(const char* at, const char* end, double& value) {
  constexpr double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                               1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr int largest_power = 22;
  constexpr std::ptrdiff_t most_digits = 19;  // fit in 64 bits
  const auto digit = [&] { return at != end ? static_cast<unsigned>(*at - '0') : 10u; };
  const bool negative = at != end && *at == '-';
  at += negative;
  const char* const begin = at;
  uint64_t mantissa = 0;
  for (unsigned d = digit(); d < 10; d = (++at, digit())) mantissa = 10 * mantissa + d;
  std::ptrdiff_t digits = at - begin;
  if (digits == 0) return nullptr;
  int power = 0;
  if (at != end && *at == '.') {
    const char* const fraction = ++at;
    for (unsigned d = digit(); d < 10; d = (++at, digit())) mantissa = 10 * mantissa + d;
    digits += at - fraction;
    power = static_cast<int>(fraction - at);
  }
  if (digits > most_digits || mantissa > uint64_t{1} << 53) return nullptr;
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool small = at != end && *at == '-';
    at += at != end && (*at == '-' || *at == '+');
    const char* const first = at;
    int exponent = 0;
    for (unsigned d = digit(); d < 10 && exponent < 1000; d = (++at, digit()))
      exponent = 10 * exponent + static_cast<int>(d);
    if (at == first) return nullptr;
    power += small ? -exponent : exponent;
  }
  if (power < -largest_power || power > largest_power) return nullptr;
  const double whole = static_cast<double>(mantissa);
  value = power < 0 ? whole / powers[-power] : whole * powers[power];
  if (negative) value = -value;
  return at;
}

}  // namespace

const char* parse_usual_number(const char* at, const char* end, double& value, char separator) {
  const auto ends = [&](const char* after) { return after == end || is_blank(*after) || *after == separator; };
  if (const char* after = parse_plain_number(at, end, value); after && ends(after)) return after;
  const NumberEnd parsed = number_from_text(at, end, value);
  return parsed.ec == std::errc{} && ends(parsed.ptr) ? parsed.ptr : nullptr;
}

double TextCursor::number(std::string_view what) {
  skip_blanks();
  double value = 0;
  if (const char* after = parse_usual_number(at_, end_, value)) {
    at_ = after;
    return value;
  }
  const std::string_view text = token();
  if (text.empty()) fail(fmt::format("truncated: the file ends where {} must follow", what));
  if (!parse_number(text, value)) fail(fmt::format("{} = {}, must be a number", what, in_quotes(text)));
  return value;
}

void TextCursor::fail(const std::string& message) const {
  throw InputError(fmt::format("{}:{}: {}", source_.path(), line_, message));
}

}  // namespace soapfilm::io
