// Text to double: std::from_chars, or strtod where the C++ library lacks it (libc++ before version 20).
#pragma once

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

namespace soapfilm {

struct NumberEnd {
  const char* ptr;
  std::errc ec;
};

/// As std::from_chars of the C++ standard; `exponent`: whether "e5" may follow.
inline NumberEnd number_from_text(const char* begin, const char* end, double& value, bool exponent = true) {
#ifdef __cpp_lib_to_chars
  const auto format = exponent ? std::chars_format::general : std::chars_format::fixed;
  const std::from_chars_result result = std::from_chars(begin, end, value, format);
  return {result.ptr, result.ec};
#else
  // Nothing that strtod takes and from_chars does not: blanks, a plus sign, hexadecimal digits.
  constexpr std::ptrdiff_t longest = 2000;
  std::string text(begin, std::min(end, begin + longest));
  text.resize(std::min(text.size(), text.find_first_of(exponent ? " \t\n\v\f\rxX" : " \t\n\v\f\rxXeE")));
  if (text.empty() || text.front() == '+') return {begin, std::errc::invalid_argument};
  char* after = nullptr;
  errno = 0;
  const double parsed = std::strtod(text.c_str(), &after);
  if (after == text.c_str()) return {begin, std::errc::invalid_argument};
  const char* const ptr = begin + (after - text.c_str());
  if (errno == ERANGE && (std::isinf(parsed) || parsed == 0)) return {ptr, std::errc::result_out_of_range};
  value = parsed;
  return {ptr, std::errc{}};
#endif
}

}  // namespace soapfilm
