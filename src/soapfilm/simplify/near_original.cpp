#include "soapfilm/simplify/near_original.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/simplify/cover.h"

namespace soapfilm {

namespace {

struct InGrid {
  const FaceGrid& grid;
  Vec3d corner(uint32_t face, size_t k) const { return grid.corner(face, k); }
  template <class Visit>
  bool any(Vec3d p, double radius, Visit&& visit) const {
    return grid.any_near(p, radius, visit);
  }
};

}  // namespace

bool NearOriginal::holds(const std::array<Vec3d, 3>& corner, double distance, double& most) {
  constexpr double long_side = 3;  // units
  const auto& [a, b, c] = corner;
  if (over_.proves(corner, distance, most)) return true;
  const Vec3d ab = b - a, bc = c - b, ca = a - c;
  const double x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca), longest = std::max({x, y, z});
  if (longest > long_side * long_side) {
    const auto both = [&](Vec3d from, Vec3d to, Vec3d tip) {
      const Vec3d middle = (from + to) * 0.5;
      return holds({from, middle, tip}, distance, most) && holds({middle, to, tip}, distance, most);
    };
    return x == longest ? both(a, b, c) : y == longest ? both(b, c, a) : both(c, a, b);
  }
  const InGrid in_grid{grid_};
  Cover cover(in_grid, distance);
  if (!cover.covers(ConvexPolygon::triangle(a, b, c))) return false;
  most = std::max(most, std::sqrt(cover.most()));
  return true;
}

}  // namespace soapfilm
