// Rounding errors, such as those after a permutation of the axes, must not reach the mesh through a measured length.
#pragma once

#include <cmath>

namespace soapfilm {

/// To about four digits.
inline double rounded(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::round(mantissa * 4096) / 4096, exponent);
}

}  // namespace soapfilm
