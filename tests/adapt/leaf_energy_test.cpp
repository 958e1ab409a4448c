#include "soapfilm/adapt/leaf_energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "adapt/random_hierarchy.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// The energies of a hierarchy as their formulas say, leaf by leaf.
struct Plain {
  const Hierarchy& h;
  double scale, variation = 0, data = 0, dual = 0;

  Plain(const Hierarchy& hierarchy, double scale_of_p) : h(hierarchy), scale(scale_of_p) {
    for (int l = 0; l < levels; ++l)
      BrickRange::whole(h.lattice.box(l).bricks).for_each([&](Vec3i b) {
        if (h.regions.has(l, b)) for_each_vertex(b, [&](Vec3i v, int) { add(l, v); });
      });
  }

  LevelBox box(int l) const { return h.lattice.box(l); }
  bool in_box(int l, Vec3i v) const { return BrickRange::whole(box(l).bricks).contains(brick_of(v)); }
  bool has(int l, Vec3i v) const { return in_box(l, v) && h.regions.has(l, brick_of(v)); }
  double u(int l, Vec3i v) const { return h.sides[static_cast<size_t>(l)].test(v) ? 1 : 0; }
  double p(int l, Vec3i v, int axis) const {
    const Level& level = h.everywhere[static_cast<size_t>(l)];
    const int32_t n = level.grid.find(brick_of(v));
    return n < 0 ? 0
                 : static_cast<double>(
                       level.p.brick(static_cast<size_t>(n), axis)[brick_offset(v.x & 7, v.y & 7, v.z & 7)]);
  }
  double f(int l, Vec3i v) const {
    const SupportField& field = h.data[static_cast<size_t>(l)];
    const int32_t n = field.grid.find(brick_of(v));
    return n < 0 || !box(l).is_free(v)
               ? 0
               : static_cast<double>(field.f.brick(static_cast<size_t>(n))[brick_offset(v.x & 7, v.y & 7, v.z & 7)]);
  }
  /// u beyond the upper face of a leaf, or of the part of it that an octant touches; u of the leaf where the problem
  /// has no such face.
  double above(int l, Vec3i v, int axis, Vec3i octant) const {
    const Vec3i up = up_from(v, axis);
    const bool open = h.lattice.open;
    if (open && !(box(l).is_free(v) && box(l).is_free(up))) return u(l, v);
    if (!in_box(l, up)) return 0;
    if (has(l, up)) return u(l, up);
    if (!h.regions.is_finer(l, brick_of(up))) return u(l + 1, parent_of(up));
    Vec3i fine = up * 2 + octant;
    fine[axis] = 2 * up[axis];
    return open && !box(l - 1).is_free(fine) ? u(l, v) : u(l - 1, fine);
  }
  bool finer_above(int l, Vec3i v) const {
    bool finer = false;
    for (int axis = 0; axis < 3; ++axis)
      finer = finer || (in_box(l, up_from(v, axis)) && h.regions.is_finer(l, brick_of(up_from(v, axis))));
    return finer;
  }
  double from_below(int l, Vec3i v, int axis) const {
    const Vec3i down = up_from(v, axis, -1);
    if (down[axis] < 0) return 0;
    if (has(l, down)) return p(l, down, axis);
    if (!h.regions.is_finer(l, brick_of(down))) return p(l + 1, parent_of(down), axis) / 4;
    double sum = 0;
    for (int k = 0; k < 8; ++k)
      if (octant_of(k)[axis] == 1) sum += p(l - 1, down * 2 + octant_of(k), axis);
    return sum;
  }

  void add(int l, Vec3i v) {
    const int parts = finer_above(l, v) ? 8 : 1;
    for (int k = 0; k < parts; ++k) {
      Vec3d g;
      for (int axis = 0; axis < 3; ++axis) g[axis] = above(l, v, axis, octant_of(k)) - u(l, v);
      variation += std::ldexp(length(g, h.norm), 2 * l) / parts;
    }
    if (!box(l).is_free(v)) return;
    data += f(l, v) * u(l, v);
    double r = 0;
    for (int axis = 0; axis < 3; ++axis) r += from_below(l, v, axis) - p(l, v, axis);
    const auto has_flux = [&](int level, Vec3i brick) {
      return h.flux[static_cast<size_t>(level)].grid.find(brick) >= 0;
    };
    if (f(l, v) == 0 || has_flux(l, brick_of(v)) || has_flux(l + 1, parent_of(brick_of(v)))) {
      dual += std::min(0.0, scale * r - f(l, v));
    } else {
      dual += std::min(0.0, scale * r) - std::max(0.0, f(l, v));
    }
  }
};

TEST(LeafEnergy, IsThatOfItsFormulas) {
  for (const Norm norm : {Norm::isotropic, Norm::anisotropic})
    for (const bool open : {false, true})
      for (uint64_t seed = 1; seed <= (sanitized ? 1 : 2); ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << " open " << open << " norm " << static_cast<int>(norm));
        const Hierarchy h(seed, norm, open);
        const LeafEnergies found = evaluate_leaves(h.regions, h.leaves(), 0, one_thread);
        const Plain plain(h, 1 / std::max(1.0, found.energies.max_dual_norm));
        EXPECT_NEAR(found.energies.total_variation, plain.variation, 1e-9 * plain.variation);
        EXPECT_NEAR(found.energies.data, plain.data, 1e-7 * std::abs(plain.variation));
        EXPECT_LE(found.energies.max_dual_norm, 1 + 1e-6);
        EXPECT_NEAR(found.energies.dual, plain.dual, 1e-6 * std::abs(plain.dual));
        EXPECT_GE(found.energies.gap, 0);
        EXPECT_GT(found.at_borders, 0);
        EXPECT_LE(found.at_borders, found.energies.gap * (1 + 1e-9));
      }
}

/// Bits do not depend on threads.
TEST(LeafEnergy, ThreadsDoNotMatter) {
  const Hierarchy h(7, Norm::isotropic, false);
  const LeafEnergies one = evaluate_leaves(h.regions, h.leaves(), 1, one_thread),
                     many = evaluate_leaves(h.regions, h.leaves(), 1, Context(3));
  EXPECT_EQ(one.energies.primal, many.energies.primal);
  EXPECT_EQ(one.energies.dual, many.energies.dual);
  EXPECT_EQ(one.at_borders, many.at_borders);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
