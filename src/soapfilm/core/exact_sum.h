// A sum of floats that does not depend on their order.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace soapfilm {

/// Exact for up to 2^64 finite terms; value() rounds it once or twice.
class ExactSum {
 public:
  void add(float term) {
    const auto bits = std::bit_cast<uint32_t>(term);
    const uint32_t exponent = bits >> 23 & 255, fraction = bits & ((1u << 23) - 1);
    // Numbers too small for a leading 1 have the exponent of the smallest that have one.
    const uint32_t digits = exponent == 0 ? fraction : fraction | 1u << 23, shift = exponent == 0 ? 1 : exponent;
    const auto part = static_cast<Wide>(int64_t{digits} << shift % stretch);
    parts_[shift / stretch] += bits >> 31 != 0 ? -part : part;
  }
  ExactSum& operator+=(const ExactSum& other) {
    for (size_t k = 0; k < parts_.size(); ++k) parts_[k] += other.parts_[k];
    return *this;
  }
  double value() const {
    double sum = 0;
    for (size_t k = 0; k < parts_.size(); ++k)
      sum += std::ldexp(static_cast<double>(parts_[k]), static_cast<int>(k * stretch) - 150);
    return sum;
  }

 private:
  __extension__ using Wide = __int128;
  static constexpr uint32_t stretch = 16;  // exponents to a part

  std::array<Wide, 256 / stretch> parts_{};  // in units of 2^(16 k - 150)
};

}  // namespace soapfilm
