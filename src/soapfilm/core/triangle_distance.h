// How far a point is from a triangle, and where the triangle is nearest.
#pragma once

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The point of the triangle nearest to p (Ericson 2005, Real-Time Collision Detection, section 5.1.5).
inline Vec3d nearest_point(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double sum = va + vb + vc;
  return a + ab * (vb / sum) + ac * (vc / sum);
}

/// Square of the distance of p to the triangle.
inline double squared_distance(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d q = nearest_point(p, a, b, c);
  return dot(p - q, p - q);
}

}  // namespace soapfilm
