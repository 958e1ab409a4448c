#include "soapfilm/pyramid/children.h"

#include <algorithm>

namespace soapfilm {

bool inside_child(const Level& coarse, size_t brick, Vec3i octant) {
  const Vec3i base = octant * half_brick;
  return coarse.u.brick(brick)[brick_offset(base.x, base.y, base.z)] > 0.5f;
}

/// Each fine vertex has an eighth of the coarse divergence. (Where a coarse vertex is free but some of its children are
/// fixed, this counts terms <= 0 too many: the bound stays a bound.)
Outside outside_child(const Level& coarse, size_t brick, Vec3i octant, const SupportField& support) {
  const int32_t n = support.grid.find(coarse.grid.coord(brick) * 2 + octant);
  const float* f = n < 0 ? nullptr : support.f.brick(static_cast<size_t>(n));
  const FreeRange range = free_range(coarse.box, coarse.grid.coord(brick));
  const CoarseFlux flux[3] = {{coarse, brick, 0}, {coarse, brick, 1}, {coarse, brick, 2}};
  const double u = inside_child(coarse, brick, octant) ? 1 : 0;
  Outside sum;
  for (int z = 0; z < half_brick; ++z)
    for (int y = 0; y < half_brick; ++y)
      for (int x = 0; x < half_brick; ++x) {
        const Vec3i at = octant * half_brick + Vec3i{x, y, z};
        if (!range.contains(at.x, at.y, at.z)) continue;
        double divergence = 0;
        for (int axis = 0; axis < 3; ++axis) {
          Vec3i below = at;
          --below[axis];
          divergence += double{flux[axis].at(below.x, below.y, below.z)} - flux[axis].at(at.x, at.y, at.z);
        }
        for (int k = 0; k < 8; ++k) {
          const Vec3i child = octant_of(k);
          const double gain = f ? f[brick_offset(2 * x + child.x, 2 * y + child.y, 2 * z + child.z)] : 0.0f;
          const double r = divergence / 8 - gain;
          sum += {gain * u, std::max(0.0, gain), std::min(0.0, r), r * u - std::min(0.0, r)};
        }
      }
  return sum;
}

}  // namespace soapfilm
