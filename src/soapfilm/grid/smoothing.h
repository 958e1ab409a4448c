// The smoothing filter of section 4.1: the box filter convolved three times with itself, sum 1 along each axis.
#pragma once

#include <array>

namespace soapfilm {

/// Taps, 3 vertices to either side.
inline constexpr std::array<float, 7> smoothing_taps = {1.0f / 27, 3.0f / 27, 6.0f / 27, 7.0f / 27,
                                                        6.0f / 27, 3.0f / 27, 1.0f / 27};
inline constexpr int smoothing_reach = 3;

}  // namespace soapfilm
