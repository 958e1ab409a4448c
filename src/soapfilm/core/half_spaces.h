// Which way triangles face, as bits: where all of a place face one half of all directions, no two sheets face each
// other.
#pragma once

#include <cstdint>

#include "soapfilm/core/vec.h"

namespace soapfilm {

inline constexpr uint32_t all_half_spaces = (uint32_t{1} << 14) - 1;

/// A bit for each of 14 directions (to a cube's faces and corners) whose half space holds the vector's tip.
inline uint32_t faced_half_spaces(Vec3d n) {
  const double sum = n.x + n.y, difference = n.x - n.y;
  const double along[] = {n.x, n.y, n.z, sum + n.z, sum - n.z, difference + n.z, difference - n.z};
  uint32_t bits = 0;
  for (const double a : along) bits = bits << 2 | uint32_t{a > 0} << 1 | uint32_t{a < 0};
  return bits;
}

}  // namespace soapfilm
