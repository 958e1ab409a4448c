// The smoothing filter of section 4.1: the box filter convolved three times with itself, sum 1 along each axis.
#pragma once

#include <array>
#include <cstddef>

#include "soapfilm/grid/layout.h"

namespace soapfilm {

/// Taps that reach 3 vertices to either side.
inline constexpr std::array<float, 7> smoothing_taps = {1.0f / 27, 3.0f / 27, 6.0f / 27, 7.0f / 27,
                                                        6.0f / 27, 3.0f / 27, 1.0f / 27};
inline constexpr int smoothing_reach = 3;

/// One pass of any odd filter: 8 outputs along x from inputs `stride` floats apart per tap; `in` is the middle tap's.
template <size_t count>
inline void filter_row(const float* in, std::ptrdiff_t stride, const std::array<float, count>& taps, float* out) {
  constexpr int reach = static_cast<int>(count) / 2;
  float sum[brick_side] = {};
  for (int j = 0; j < static_cast<int>(count); ++j)
    for (int x = 0; x < brick_side; ++x) sum[x] += taps[static_cast<size_t>(j)] * in[(j - reach) * stride + x];
  for (int x = 0; x < brick_side; ++x) out[x] = sum[x];
}

}  // namespace soapfilm
