// Is a convex polygon within a distance of a surface? Decided by a bound that holds for each of its points.
#pragma once

#include <array>
#include <cstdint>

#include "soapfilm/core/triangle_distance.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Few corners, in a plane, in order.
struct ConvexPolygon {
  static constexpr int most = 12;
  std::array<Vec3d, most> corner;
  int count = 0;

  static ConvexPolygon triangle(Vec3d a, Vec3d b, Vec3d c) { return {{a, b, c}, 3}; }
  bool add(Vec3d p) {
    if (count == most) return false;
    corner[static_cast<size_t>(count++)] = p;
    return true;
  }
  Vec3d at(int i) const { return corner[static_cast<size_t>(i)]; }
  Vec3d mean() const;
};

/// Parts on the two sides of a plane; false where one gets too many corners.
bool cut(const ConvexPolygon& polygon, Vec3d normal, Vec3d on_plane, ConvexPolygon& above, ConvexPolygon& below);

/// A triangle is convex, so is the set of all points within a distance of it: a convex polygon whose corners are in
/// that set lies in it. A polygon that is near no single triangle is cut along the sides of the triangle nearest to its
/// middle, or else halved, and each part is tried again. What is cut is finite, so "no" may be wrong, "yes" is not.
///
/// `Find`: any(p, radius, visit) visits the numbers of triangles that may be within the radius of p until visit()
/// returns true, and returns whether it did; corner(number, k).
template <class Find>
class Cover {
 public:
  Cover(const Find& find, double distance) : find_(find), distance_(distance), limit_(distance * distance) {}

  bool covers(const ConvexPolygon& polygon, int depth = 40) {
    const Vec3d middle = polygon.mean();
    uint32_t nearest = none;
    double least = limit_;
    const bool whole = find_.any(middle, distance_, [&](uint32_t t) {
      const double d = squared_distance(middle, find_.corner(t, 0), find_.corner(t, 1), find_.corner(t, 2));
      if (!(d <= limit_)) return false;
      if (is_within(polygon, t)) return true;
      if (nearest == none || d < least) {
        least = d;
        nearest = t;
      }
      return false;
    });
    if (whole) return true;
    if (nearest == none || depth == 0) return false;
    return covers_parts(polygon, nearest, depth - 1);
  }

  /// The largest square of a corner's distance that was accepted.
  double most() const { return most_; }

 private:
  static constexpr uint32_t none = ~uint32_t{0};

  bool is_within(const ConvexPolygon& polygon, uint32_t t) {
    double most = 0;
    for (int i = 0; i < polygon.count; ++i) {
      const double d = squared_distance(polygon.at(i), find_.corner(t, 0), find_.corner(t, 1), find_.corner(t, 2));
      if (!(d <= limit_)) return false;
      most = std::max(most, d);
    }
    most_ = std::max(most_, most);
    return true;
  }

  /// The part in the prism over the triangle, then those beyond its sides.
  bool covers_parts(const ConvexPolygon& polygon, uint32_t t, int depth) {
    const Vec3d a = find_.corner(t, 0), b = find_.corner(t, 1), c = find_.corner(t, 2);
    const Vec3d n = cross(b - a, c - a);
    std::array<ConvexPolygon, 3> beyond;
    size_t parts = 0;
    ConvexPolygon rest = polygon;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d from = find_.corner(t, k), to = find_.corner(t, (k + 1) % 3);
      const Vec3d inward = normalized(cross(n, to - from));
      double lowest = 0, highest = 0;
      for (int i = 0; i < rest.count; ++i) {
        const double h = dot(inward, rest.at(i) - from);
        lowest = std::min(lowest, h);
        highest = std::max(highest, h);
      }
      constexpr double nothing = 1e-7;
      if (lowest > -nothing) continue;
      if (highest < nothing) return halves(polygon, depth);
      ConvexPolygon inside;
      if (!cut(rest, inward, from, inside, beyond[parts])) return halves(polygon, depth);
      if (inside.count < 3) return halves(polygon, depth);
      if (beyond[parts].count >= 3) ++parts;
      rest = inside;
    }
    if (parts == 0) return halves(polygon, depth);
    if (!is_within(rest, t) && !halves(rest, depth)) return false;
    for (size_t i = 0; i < parts; ++i)
      if (!covers(beyond[i], depth)) return false;
    return true;
  }

  /// Across the longest side or diagonal.
  bool halves(const ConvexPolygon& polygon, int depth) {
    double longest = 0;
    Vec3d along;
    for (int i = 0; i < polygon.count; ++i)
      for (int j = i + 1; j < polygon.count; ++j) {
        const Vec3d d = polygon.at(j) - polygon.at(i);
        if (dot(d, d) > longest) {
          longest = dot(d, d);
          along = d;
        }
      }
    constexpr double smallest = 0.04;  // of the squared distance: parts this small near no triangle are near none
    if (longest < smallest * limit_ || depth == 0) return false;
    ConvexPolygon above, below;
    if (!cut(polygon, along, polygon.mean(), above, below)) return false;
    return covers(above, depth - 1) && covers(below, depth - 1);
  }

  const Find& find_;
  double distance_, limit_;
  double most_ = 0;
};

}  // namespace soapfilm
