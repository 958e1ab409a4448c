#include "soapfilm/core/triangle_pair.h"

#include <algorithm>
#include <cmath>

namespace soapfilm {

namespace {

__extension__ using Wide = __int128;

int sign(Wide value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

/// The side of the plane a, b, c (counter-clockwise seen from +) on which d is: sign of det [b - a, c - a, d - a].
int side_of_plane(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c, const LatticePoint& d) {
  const LatticePoint u = b - a, v = c - a, w = d - a;  // below 2^40: exact as doubles too
  const auto x = static_cast<Vec3d>(u), y = static_cast<Vec3d>(v), z = static_cast<Vec3d>(w);
  const double determinant = dot(cross(x, y), z);
  const double magnitude = (std::abs(x.y * y.z) + std::abs(x.z * y.y)) * std::abs(z.x) +
                           (std::abs(x.z * y.x) + std::abs(x.x * y.z)) * std::abs(z.y) +
                           (std::abs(x.x * y.y) + std::abs(x.y * y.x)) * std::abs(z.z);
  constexpr double rounding = 2e-15;  // nine roundings of 2^-53 at most, twice that
  if (std::abs(determinant) > rounding * magnitude) return determinant > 0 ? 1 : -1;
  const Wide i = Wide{u.y} * v.z - Wide{u.z} * v.y;
  const Wide j = Wide{u.z} * v.x - Wide{u.x} * v.z;
  const Wide k = Wide{u.x} * v.y - Wide{u.y} * v.x;
  return sign(i * w.x + j * w.y + k * w.z);
}

/// The plane of a flat figure, projected along its largest normal component: two coordinates in which it keeps an area.
struct Projection {
  int u = 0;
  int v = 1;

  explicit Projection(const LatticeTriangle& t) {
    const auto n = cross(static_cast<Vec3d>(t[1] - t[0]), static_cast<Vec3d>(t[2] - t[0]));
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const int dropped = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    u = (dropped + 1) % 3;
    v = (dropped + 2) % 3;
  }
  /// +1 if a, b, c are counter-clockwise.
  int orientation(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) const {
    return sign(Wide{b[u] - a[u]} * (c[v] - a[v]) - Wide{b[v] - a[v]} * (c[u] - a[u]));
  }
  bool between(const LatticePoint& a, const LatticePoint& b, const LatticePoint& on_line) const {
    return std::min(a[u], b[u]) <= on_line[u] && on_line[u] <= std::max(a[u], b[u]) &&
           std::min(a[v], b[v]) <= on_line[v] && on_line[v] <= std::max(a[v], b[v]);
  }
};

bool segments_meet(const Projection& seen, const LatticePoint& p, const LatticePoint& q, const LatticePoint& a,
                   const LatticePoint& b) {
  const int pa = seen.orientation(p, q, a), pb = seen.orientation(p, q, b);
  const int ap = seen.orientation(a, b, p), aq = seen.orientation(a, b, q);
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && seen.between(p, q, a)) || (pb == 0 && seen.between(p, q, b)) ||
         (ap == 0 && seen.between(a, b, p)) || (aq == 0 && seen.between(a, b, q));
}

/// Whether p, in the plane of t, lies in t.
bool contains(const Projection& seen, const LatticeTriangle& t, const LatticePoint& p) {
  const int a = seen.orientation(t[0], t[1], p), b = seen.orientation(t[1], t[2], p),
            c = seen.orientation(t[2], t[0], p);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

bool coplanar_segment_meets(const LatticePoint& p, const LatticePoint& q, const LatticeTriangle& t) {
  const Projection seen(t);
  if (contains(seen, t, p) || contains(seen, t, q)) return true;
  for (int k = 0; k < 3; ++k)
    if (segments_meet(seen, p, q, t[k], t[(k + 1) % 3])) return true;
  return false;
}

/// Whether the closed segment and the closed triangle have a point in common.
bool segment_meets(const LatticePoint& p, const LatticePoint& q, const LatticeTriangle& t) {
  const int at_p = side_of_plane(t[0], t[1], t[2], p);
  const int at_q = side_of_plane(t[0], t[1], t[2], q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return coplanar_segment_meets(p, q, t);
  if (at_p == 0) return contains(Projection(t), t, p);
  if (at_q == 0) return contains(Projection(t), t, q);
  // The line crosses the triangle if it passes all three edges on the same side.
  const int a = side_of_plane(p, q, t[0], t[1]), b = side_of_plane(p, q, t[1], t[2]),
            c = side_of_plane(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// Whether all corners of one are strictly on one side of the other's plane.
bool apart(const LatticeTriangle& a, const LatticeTriangle& b) {
  const int s = side_of_plane(a[0], a[1], a[2], b[0]);
  return s != 0 && side_of_plane(a[0], a[1], a[2], b[1]) == s && side_of_plane(a[0], a[1], a[2], b[2]) == s;
}

bool meet(const LatticeTriangle& a, const LatticeTriangle& b) {
  if (apart(a, b) || apart(b, a)) return false;
  for (int k = 0; k < 3; ++k)
    if (segment_meets(a[k], a[(k + 1) % 3], b) || segment_meets(b[k], b[(k + 1) % 3], a)) return true;
  return false;
}

/// Two triangles with a common edge meet beyond it only if they are folded onto each other.
bool folded(const LatticePoint& from, const LatticePoint& to, const LatticePoint& tip, const LatticePoint& other) {
  if (side_of_plane(from, to, tip, other) != 0) return false;
  const Projection seen({from, to, tip});
  return seen.orientation(from, to, tip) == seen.orientation(from, to, other);
}

/// Permuted cyclically so that the corner `first` comes first.
LatticeTriangle permuted(const LatticeTriangle& t, int first) {
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

}  // namespace

bool is_flat(const LatticeTriangle& t) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const LatticePoint a = t[1] - t[0], b = t[2] - t[0];
    if (Wide{a[u]} * b[v] != Wide{a[v]} * b[u]) return false;
  }
  return true;
}

bool improperly_meet(const LatticeTriangle& a, const LatticeTriangle& b) {
  int shared = 0;
  int in_a = 0, in_b = 0;      // a common corner
  int lone_a = 0, lone_b = 0;  // sums of the indices of common corners, then the one that is not common
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!(a[i] == b[j])) continue;
      ++shared;
      in_a = i;
      in_b = j;
      lone_a += i;
      lone_b += j;
    }
  }
  if (shared == 0) return meet(a, b);
  if (shared == 3) return true;
  if (shared == 2) {
    const LatticeTriangle t = permuted(a, 3 - lone_a);
    return folded(t[1], t[2], t[0], b[3 - lone_b]);
  }
  // One common corner: anything else in common reaches the opposite edge of one of the two.
  const LatticeTriangle s = permuted(a, in_a), t = permuted(b, in_b);
  return segment_meets(s[1], s[2], t) || segment_meets(t[1], t[2], s);
}

}  // namespace soapfilm
