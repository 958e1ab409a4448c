// Functions of the C library, rounded to float: their last digits differ between libraries, and between processors
// with and without fused multiplication, and the same input shall give the same mesh everywhere.
#pragma once

#include <cmath>

namespace soapfilm {

inline double portable_pow(double base, double exponent) { return static_cast<float>(std::pow(base, exponent)); }
inline double portable_exp(double x) { return static_cast<float>(std::exp(x)); }
inline double portable_log1p(double x) { return static_cast<float>(std::log1p(x)); }
inline double portable_log2(double x) { return static_cast<float>(std::log2(x)); }
inline double portable_cos(double x) { return static_cast<float>(std::cos(x)); }
inline double portable_acos(double x) { return static_cast<float>(std::acos(x)); }

}  // namespace soapfilm
