// Points, vectors and boxes: the only geometry types of the public headers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "soapfilm/export.h"

namespace SOAPFILM_API soapfilm {

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr const T& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr bool operator==(const Vec3&) const = default;

  template <class U>
  constexpr explicit operator Vec3<U>() const {
    return {static_cast<U>(x), static_cast<U>(y), static_cast<U>(z)};
  }
};

using Vec3d = Vec3<double>;
using Vec3f = Vec3<float>;
using Vec3i = Vec3<int32_t>;

/// Axis-aligned box, closed; a default box is empty.
struct Box3d {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3d lo{infinity, infinity, infinity};
  Vec3d hi{-infinity, -infinity, -infinity};

  bool empty() const { return lo.x > hi.x; }
  Vec3d size() const { return empty() ? Vec3d{} : Vec3d{hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}; }
  Vec3d center() const {
    return empty() ? Vec3d{} : Vec3d{(lo.x + hi.x) * 0.5, (lo.y + hi.y) * 0.5, (lo.z + hi.z) * 0.5};
  }
  double longest() const { return std::max({size().x, size().y, size().z}); }
  double diagonal() const { return std::sqrt(size().x * size().x + size().y * size().y + size().z * size().z); }
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
