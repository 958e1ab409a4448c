// How far from zero coordinates lie: rounding grows with it.
#pragma once

#include <algorithm>
#include <cmath>

#include "soapfilm/vec.h"

namespace soapfilm {

/// The largest absolute coordinate of a box that is not empty.
inline double farthest_coordinate(const Box3d& box) {
  double farthest = 0;
  for (const Vec3d& corner : {box.lo, box.hi})
    farthest = std::max({farthest, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  return farthest;
}

}  // namespace soapfilm
