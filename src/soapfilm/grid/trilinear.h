#pragma once

#include <array>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Value and gradient (per voxel) of a field at a point.
template <class T>
struct FieldJet {
  T value = 0;
  Vec3<T> gradient;
};

/// Trilinear interpolation in a cell: `v` at its corners, x fastest; `t` in [0, 1] along each axis.
template <class T>
FieldJet<T> trilinear(const std::array<T, 8>& v, Vec3<T> t) {
  const auto mix = [](T a, T b, T s) { return a + s * (b - a); };
  const T x00 = mix(v[0], v[1], t.x), x10 = mix(v[2], v[3], t.x);
  const T x01 = mix(v[4], v[5], t.x), x11 = mix(v[6], v[7], t.x);
  const T y0 = mix(x00, x10, t.y), y1 = mix(x01, x11, t.y);
  const T dx = mix(mix(v[1] - v[0], v[3] - v[2], t.y), mix(v[5] - v[4], v[7] - v[6], t.y), t.z);
  return {mix(y0, y1, t.z), {dx, mix(x10 - x00, x11 - x01, t.z), y1 - y0}};
}

}  // namespace soapfilm
