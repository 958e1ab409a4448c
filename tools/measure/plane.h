// An oriented plane, and triangles cut by it.
#pragma once

#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

struct Plane {
  Vec3d point;
  Vec3d normal{0, 0, 1};  ///< unit; "above" is where it points

  double height(Vec3d p) const { return dot(p - point, normal); }
};

/// The corners of a convex polygon in order.
using Polygon = std::vector<Vec3d>;

/// The part of a convex polygon in which `value`, a linear function, is >= 0; empty if there is none.
template <class Value>
Polygon clipped(const Polygon& polygon, const Value& value) {
  Polygon kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double at_a = value(a), at_b = value(b);
    if (at_a >= 0) kept.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) kept.push_back(a + (b - a) * (at_a / (at_a - at_b)));
  }
  return kept;
}

}  // namespace soapfilm
