#pragma once

#include <algorithm>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The bricks lo to hi along each axis, both included; none where hi is below lo.
struct BrickRange {
  Vec3i lo, hi;

  static BrickRange whole(Vec3i bricks) { return {{0, 0, 0}, bricks - Vec3i{1, 1, 1}}; }

  bool empty() const { return hi.x < lo.x || hi.y < lo.y || hi.z < lo.z; }
  bool contains(Vec3i b) const {
    return b.x >= lo.x && b.y >= lo.y && b.z >= lo.z && b.x <= hi.x && b.y <= hi.y && b.z <= hi.z;
  }
  /// Bricks, in double: of a large box there are more than an integer holds.
  double count() const {
    return empty() ? 0 : (double{1} + hi.x - lo.x) * (double{1} + hi.y - lo.y) * (double{1} + hi.z - lo.z);
  }
  BrickRange common(const BrickRange& other) const {
    BrickRange both;
    for (int axis = 0; axis < 3; ++axis) {
      both.lo[axis] = std::max(lo[axis], other.lo[axis]);
      both.hi[axis] = std::min(hi[axis], other.hi[axis]);
    }
    return both;
  }

  /// visit(b), x fastest, then y, then z.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (int z = lo.z; z <= hi.z; ++z)
      for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x) visit(Vec3i{x, y, z});
  }
};

}  // namespace soapfilm
