#pragma once

#include <algorithm>
#include <limits>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Axis-aligned box, closed; a default box is empty.
struct Box3d {
  Vec3d lo{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3d hi{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
           -std::numeric_limits<double>::infinity()};

  bool empty() const { return lo.x > hi.x; }
  Vec3d size() const { return empty() ? Vec3d{} : hi - lo; }
  Vec3d centre() const { return empty() ? Vec3d{} : (lo + hi) * 0.5; }
  double longest() const {
    const Vec3d s = size();
    return std::max({s.x, s.y, s.z});
  }
  double diagonal() const { return norm(size()); }

  void extend(Vec3d p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  void extend(const Box3d& other) {
    lo = {std::min(lo.x, other.lo.x), std::min(lo.y, other.lo.y), std::min(lo.z, other.lo.z)};
    hi = {std::max(hi.x, other.hi.x), std::max(hi.y, other.hi.y), std::max(hi.z, other.hi.z)};
  }
};

}  // namespace soapfilm
