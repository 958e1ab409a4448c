// What the C++ library of Emscripten 3.1.6 (libc++ 14) lacks of C++20 and the engine uses; included before every file.
#pragma once

#include <atomic>
#include <bit>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <type_traits>

#ifndef __cpp_lib_atomic_ref
namespace std {

/// There is one thread: nothing needs to be atomic.
template <class T>
class atomic_ref {
 public:
  explicit atomic_ref(T& value) : value_(value) {}
  T load(memory_order = memory_order_seq_cst) const { return value_; }
  void store(T value, memory_order = memory_order_seq_cst) const { value_ = value; }
  T fetch_and(T value, memory_order = memory_order_seq_cst) const {
    const T old = value_;
    value_ &= value;
    return old;
  }
  T fetch_or(T value, memory_order = memory_order_seq_cst) const {
    const T old = value_;
    value_ |= value;
    return old;
  }

 private:
  T& value_;
};

}  // namespace std
#endif

#ifndef __cpp_lib_bit_cast
namespace std {

template <class To, class From>
requires(sizeof(To) == sizeof(From) && is_trivially_copyable_v<To> && is_trivially_copyable_v<From>) constexpr To
    bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

}  // namespace std
#endif

#ifndef __cpp_lib_smart_ptr_for_overwrite
namespace std {

template <class Array>
unique_ptr<Array> make_unique_for_overwrite(size_t count) {
  return unique_ptr<Array>(new remove_extent_t<Array>[count]);
}

}  // namespace std
#endif

#ifndef __cpp_lib_to_chars
namespace std {

/// The fewest digits that read back as the same value.
template <class Number>
requires(is_floating_point_v<Number>) to_chars_result to_chars(char* begin, char* end, Number value) {
  constexpr int most_digits = sizeof(Number) == 4 ? 9 : 17;
  char text[40];
  for (int digits = 1; digits <= most_digits; ++digits) {
    snprintf(text, sizeof text, "%.*g", digits, static_cast<double>(value));
    if (static_cast<Number>(strtod(text, nullptr)) == value) break;
  }
  const size_t length = strlen(text);
  if (length > static_cast<size_t>(end - begin)) return {end, errc::value_too_large};
  memcpy(begin, text, length);
  return {begin + length, errc{}};
}

}  // namespace std
#endif
