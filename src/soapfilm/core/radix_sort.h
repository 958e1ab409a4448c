// Sorting integers in time linear in their number.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace soapfilm {

/// Sorts keys by their lowest `bits`, and keeps the order of those that agree in these: lowest digits first (Knuth, The
/// Art of Computer Programming 3, section 5.2.5). Takes as much memory again as the keys while it works.
inline void radix_sort(std::vector<uint64_t>& keys, int bits) {
  constexpr int digit_bits = 12;
  constexpr size_t digits = size_t{1} << digit_bits;
  std::vector<uint64_t> other(keys.size());
  for (int shift = 0; shift < bits; shift += digit_bits) {
    const size_t mask = (size_t{1} << std::min(digit_bits, bits - shift)) - 1;
    std::array<size_t, digits> next{};
    for (const uint64_t key : keys) ++next[key >> shift & mask];
    size_t sum = 0;
    for (size_t& n : next) {
      const size_t count = n;
      n = sum;
      sum += count;
    }
    for (const uint64_t key : keys) other[next[key >> shift & mask]++] = key;
    keys.swap(other);
  }
}

}  // namespace soapfilm
