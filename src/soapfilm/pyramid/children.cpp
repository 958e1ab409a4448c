#include "soapfilm/pyramid/children.h"

#include <algorithm>
#include <array>

namespace soapfilm {

bool inside_child(const Level& coarse, size_t brick, Vec3i octant) {
  Vec3i at = octant_base(octant);
  if (coarse.box.open && at_border(coarse.box, coarse.grid.coord(brick))) {  // decided by the vertices that are free
    const Vec3i first = coarse.grid.first_vertex(brick);
    const Vec3i free = nearest_free(coarse.box, first + at) - first;
    for (int axis = 0; axis < 3; ++axis)
      if (free[axis] < at[axis] || free[axis] >= at[axis] + half_brick) return false;
    at = free;
  }
  return coarse.u.brick(brick)[brick_offset(at.x, at.y, at.z)] > 0.5f;
}

namespace {

/// Minus the divergence of the fluxes at the coarse vertices of an octant, x fastest; 0 at fixed ones.
std::array<double, octant_volume> fluxes_in(const Level& coarse, size_t brick, Vec3i octant) {
  std::array<double, octant_volume> sums{};
  for_each_flux(coarse, brick, [&](const auto& flux) {
    flux.for_each_row(octant, [&](int y, int z, const auto& here, const auto& below) {
      double* sum = sums.data() + octant_offset(0, y, z);
      for (size_t x = 0; x < here.size(); ++x) sum[x] += double{below[x]} - here[x];
    });
  });
  const Vec3i base = octant_base(octant);
  free_range(coarse.box, coarse.grid.coord(brick)).for_each_fixed(base, half_brick, [&](int x, int y, int z) {
    sums[static_cast<size_t>(octant_offset(x - base.x, y - base.y, z - base.z))] = 0;
  });
  return sums;
}

}  // namespace

/// Each fine vertex has an eighth of the coarse divergence. (If a coarse vertex is free but some of its children are
/// fixed, this adds too many terms <= 0: the result is still a bound.)
OutsideTerms outside_child(const Level& coarse, size_t brick, Vec3i octant, const SupportField& support) {
  const std::array<double, octant_volume> in = fluxes_in(coarse, brick, octant);
  const double u = inside_child(coarse, brick, octant) ? 1 : 0;
  OutsideTerms sum;
  const auto add = [&](double r) {
    sum.dual += std::min(0.0, r);
    sum.gap += r * u - std::min(0.0, r);
  };
  const int32_t n = support.grid.find(child_of(coarse.grid.coord(brick), octant));
  if (n < 0) {
    for (const double r : in) add(r);
    return sum;
  }
  const float* f = support.f.brick(static_cast<size_t>(n));
  const Vec3i base = octant_base(octant);
  const FreeRange range = free_range(coarse.box, coarse.grid.coord(brick));  // at an open border, the children's too
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y)
      for (int x = 0; x < brick_side; ++x) {
        if (coarse.box.open && !range.contains(base.x + x / 2, base.y + y / 2, base.z + z / 2)) continue;
        const double gain = f[brick_offset(x, y, z)];
        sum.data += gain * u;
        sum.gain += std::max(0.0, gain);
        add(in[static_cast<size_t>(octant_offset(x / 2, y / 2, z / 2))] / 8 - gain);
      }
  return sum;
}

}  // namespace soapfilm
