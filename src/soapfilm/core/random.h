// Random numbers with explicit seeds, the same on every platform: the standard library's distributions are not.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace soapfilm {

/// SplitMix64 (Steele, Lea, Flood 2014): full period 2^64, good enough to place and disturb samples.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t next() {
    uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Standard normal (Box and Muller).
  double normal() {
    const double u = 1.0 - uniform();
    const double v = uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
  }

 private:
  uint64_t state_;
};

/// A random index in the k-th interval of `length` in [0, count): indices at equal distances might all be in similar
/// places, for example in one layer of every brick.
inline size_t one_of_stretch(size_t k, size_t length, size_t count) {
  const size_t begin = k * length;
  return begin + Random(k).next() % std::min(length, count - begin);
}

}  // namespace soapfilm
