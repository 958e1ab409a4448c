// What the C++ library of Emscripten 3.1.6 (libc++ 14) lacks of C++20 and the engine uses; included before every file.
#pragma once

#include <atomic>
#include <bit>
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
  requires(sizeof(To) == sizeof(From) && is_trivially_copyable_v<To> && is_trivially_copyable_v<From>)
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

}  // namespace std
#endif
