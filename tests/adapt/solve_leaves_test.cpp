#include "soapfilm/adapt/solve_leaves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "adapt/random_hierarchy.h"
#include "soapfilm/adapt/leaf_labels.h"
#include "soapfilm/pyramid/children.h"
#include "soapfilm/solve/level_solver.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// All leaves of a hierarchy as levels that can be solved, with followers; u and p of leaves are random.
std::vector<Level> all_leaves(Hierarchy& h) {
  std::vector<Level> found(levels);
  for (int l = levels - 1; l >= 0; --l) {
    const auto n = static_cast<size_t>(l);
    const LevelBox box = h.lattice.box(l);
    const float lambda = 0.05f * static_cast<float>(1 << (2 * l));
    if (l == levels - 1) {
      found[n] = make_level(box, lambda, BrickMask::whole(box.bricks), h.data[n].grid, h.data[n].f, one_thread, h.norm);
    } else {
      const auto places = std::make_shared<const BrickMask>(children_of(h.regions.finer(l + 1), box.bricks));
      const BrickMask band = with_followers(h.regions, l, *places, found[n + 1].grid);
      found[n] = continue_in_places(found[n + 1], box, band, places, {}, h.data[n], one_thread);
    }
    h.fill_flux(found[n]);
    for (size_t b = 0; b < found[n].grid.size(); ++b)
      for_each_vertex(found[n].grid.coord(b), [&](Vec3i v, int i) {
        found[n].u.brick(b)[i] = box.is_free(v) ? static_cast<float>(h.random.uniform()) : 0.0f;
      });
  }
  return found;
}

/// The iteration leaf by leaf, in double.
class Plain {
 public:
  Plain(const Hierarchy& h, const std::vector<Level>& from) : h_(h), from_(from) {
    for (int l = 0; l < levels; ++l) {
      const Vec3i bricks = h.lattice.box(l).bricks;
      size_[static_cast<size_t>(l)] = bricks * brick_side;
      const auto count = static_cast<size_t>(bricks.x) * static_cast<size_t>(bricks.y) * static_cast<size_t>(bricks.z);
      State& s = states_[static_cast<size_t>(l)];
      for (auto* values : {&s.u, &s.u_bar, &s.p[0], &s.p[1], &s.p[2]}) values->resize(count * brick_volume);
      for_each_leaf(l, [&](Vec3i v, size_t b, int i) {
        const Level& level = from[static_cast<size_t>(l)];
        s.u[at(l, v)] = static_cast<double>(level.u.brick(b)[i]);
        for (int axis = 0; axis < 3; ++axis)
          s.p[static_cast<size_t>(axis)][at(l, v)] = static_cast<double>(level.p.brick(b, axis)[i]);
      });
    }
  }

  void iterate(double balance) {
    for (int l = 0; l < levels; ++l)
      for_each_leaf(l, [&](Vec3i v, size_t b, int i) {
        const Level& level = from_[static_cast<size_t>(l)];
        double in = 0;
        for (int axis = 0; axis < 3; ++axis) in += p_below(l, v, axis) - p(l, v, axis);
        double& u = states_[static_cast<size_t>(l)].u[at(l, v)];
        const double next =
            std::clamp(u - steps(l, balance).tau * (in - level.data(b)[i]), 0.0, level.box.is_free(v) ? 1.0 : 0.0);
        states_[static_cast<size_t>(l)].u_bar[at(l, v)] = 2 * next - u;
        u = next;
      });
    for (int l = 0; l < levels; ++l)
      for_each_leaf(l, [&](Vec3i v, size_t, int) {
        const LevelBox box = h_.lattice.box(l);
        Vec3d q;
        for (int axis = 0; axis < 3; ++axis) {
          const bool exists = !box.open || (box.is_free(v) && box.is_free(up_from(v, axis)));
          q[axis] = p(l, v, axis);
          if (exists) q[axis] += steps(l, balance).sigma * (above(l, v, axis) - u_bar(l, v));
        }
        const double radius = static_cast<double>(dual_radius(from_[static_cast<size_t>(l)]));
        const double longest = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
        for (int axis = 0; axis < 3; ++axis) {
          double& own = states_[static_cast<size_t>(l)].p[static_cast<size_t>(axis)][at(l, v)];
          if (h_.norm == Norm::isotropic)
            own = q[axis] * std::min(1.0, radius / std::max(1e-30, norm(q)));
          else
            own = longest > 0 ? std::clamp(q[axis], -radius, radius) : 0;
        }
      });
  }

  double u(int l, Vec3i v) const { return states_[static_cast<size_t>(l)].u[at(l, v)]; }
  double p(int l, Vec3i v, int axis) const {
    return states_[static_cast<size_t>(l)].p[static_cast<size_t>(axis)][at(l, v)];
  }
  template <class Visit>
  void for_each_leaf(int l, Visit&& visit) const {
    const BrickGrid& grid = from_[static_cast<size_t>(l)].grid;
    for (size_t b = 0; b < grid.size(); ++b)
      if (h_.regions.has(l, grid.coord(b))) for_each_vertex(grid.coord(b), [&](Vec3i v, int i) { visit(v, b, i); });
  }

 private:
  struct State {
    std::vector<double> u, u_bar, p[3];
  };
  size_t at(int l, Vec3i v) const {
    const Vec3i size = size_[static_cast<size_t>(l)];
    return static_cast<size_t>(v.x) +
           static_cast<size_t>(size.x) *
               (static_cast<size_t>(v.y) + static_cast<size_t>(size.y) * static_cast<size_t>(v.z));
  }
  struct Steps {
    double sigma, tau;
  };
  Steps steps(int l, double balance) const {
    const StepSizes of_level = step_sizes(balance * static_cast<double>(from_[static_cast<size_t>(l)].lambda));
    return {static_cast<double>(of_level.sigma), static_cast<double>(of_level.tau)};
  }
  double u_bar(int l, Vec3i v) const { return states_[static_cast<size_t>(l)].u_bar[at(l, v)]; }
  bool in_box(int l, Vec3i v) const { return BrickRange::whole(h_.lattice.box(l).bricks).contains(brick_of(v)); }

  double p_below(int l, Vec3i v, int axis) const {
    const Vec3i down = up_from(v, axis, -1);
    if (down[axis] < 0) return 0;
    if (h_.regions.has(l, brick_of(down))) return p(l, down, axis);
    if (!h_.regions.is_finer(l, brick_of(down))) return p(l + 1, parent_of(down), axis) / 4;
    double sum = 0;
    for (int k = 0; k < 8; ++k)
      if (octant_of(k)[axis] == 1) sum += p(l - 1, down * 2 + octant_of(k), axis);
    return sum;
  }
  double above(int l, Vec3i v, int axis) const {
    const Vec3i up = up_from(v, axis);
    if (!in_box(l, up)) return 0;
    if (h_.regions.has(l, brick_of(up))) return u_bar(l, up);
    if (!h_.regions.is_finer(l, brick_of(up))) return u_bar(l + 1, parent_of(up));
    double sum = 0;
    for (int k = 0; k < 8; ++k)
      if (octant_of(k)[axis] == 0) sum += u_bar(l - 1, up * 2 + octant_of(k));
    return sum / 4;
  }

  const Hierarchy& h_;
  const std::vector<Level>& from_;
  Vec3i size_[levels];
  State states_[levels];
};

TEST(SolveLeaves, IsOneIterationOnAllLeaves) {
  constexpr double balance = 0.7;
  for (const Norm norm : {Norm::isotropic, Norm::anisotropic})
    for (const bool open : {false, true}) {
      if (sanitized && open == (norm == Norm::isotropic)) continue;
      SCOPED_TRACE(testing::Message() << "open " << open << " norm " << static_cast<int>(norm));
      Hierarchy h(3, norm, open);
      std::vector<Level> state = all_leaves(h);
      Plain plain(h, state);
      const int iterations = sanitized ? 2 : 5;
      for (int k = 0; k < iterations; ++k) plain.iterate(balance);
      int asked = 0;
      solve_leaves(h.regions, state, {balance, iterations, 2}, one_thread, [&](int) {
        ++asked;
        return false;
      });
      EXPECT_EQ(asked, iterations / 2);
      double worst_u = 0, worst_p = 0;
      for (int l = 0; l < levels; ++l)
        plain.for_each_leaf(l, [&](Vec3i v, size_t b, int i) {
          const Level& level = state[static_cast<size_t>(l)];
          worst_u = std::max(worst_u, std::abs(plain.u(l, v) - static_cast<double>(level.u.brick(b)[i])));
          for (int axis = 0; axis < 3; ++axis)
            worst_p = std::max(worst_p, std::abs(plain.p(l, v, axis) - static_cast<double>(level.p.brick(b, axis)[i])) /
                                            static_cast<double>(level.lambda));
        });
      EXPECT_LT(worst_u, 1e-4);
      EXPECT_LT(worst_p, 1e-4);
    }
}

/// Levels with the data of a ball, u and p zero: one has half of the box, the next coarser one the rest.
struct Ball {
  Lattice lattice = small_lattice();
  Regions regions = halves(lattice, 5, 5);
  std::vector<SupportField> data;
  std::vector<Level> state;

  static double ball(Vec3d q) { return 40 - norm(q - Vec3d{75, 64, 65}); }

  Ball() {
    for (int l = 0; l < 2; ++l) {
      SupportField& field = data.emplace_back();
      field.grid = BrickGrid(BrickMask::whole(lattice.box(l).bricks), one_thread);
      field.f = Field<float>(field.grid);
      for (size_t b = 0; b < field.grid.size(); ++b)
        for_each_vertex(field.grid.coord(b), [&](Vec3i v, int i) {
          const double inside = ball(leaf_center(l, v));
          if (std::abs(inside) < 6)
            field.f.brick(b)[i] = static_cast<float>(std::ldexp(std::clamp(inside / 2, -1.0, 1.0), 3 * l));
        });
    }
    state.resize(2);
    const LevelBox whole = lattice.box(1), box = lattice.box(0);
    state[1] = make_level(whole, 4, BrickMask::whole(whole.bricks), data[1].grid, data[1].f, one_thread);
    const auto places = std::make_shared<const BrickMask>(children_of(regions.finer(1), box.bricks));
    state[0] = continue_in_places(state[1], box, with_followers(regions, 0, *places, state[1].grid), places, {},
                                  data[0], one_thread);
  }
  LeafEnergies energies() const {
    const Labels sides[] = {labels_of(state[0], 0.5f, one_thread), labels_of(state[1], 0.5f, one_thread)};
    const LeafLevel leaves[] = {{&sides[0], &data[0], &state[0]}, {&sides[1], &data[1], &state[1]}};
    return evaluate_leaves(regions, leaves, 0, one_thread);
  }
};

/// The bound comes near the energy of the sides, and these are the ball's on both levels.
TEST(SolveLeaves, ComesNearTheOptimumAcrossLevels) {
  Ball of;
  const double most = 0.05;  // octants with fluxes of their own would leave less
  solve_leaves(of.regions, of.state, {1, 600, 50}, one_thread,
               [&](int) { return of.energies().energies.relative_gap(1) < most; });
  const LeafEnergies found = of.energies();
  EXPECT_GE(found.energies.gap, 0);
  EXPECT_LT(found.energies.relative_gap(1), most);
  const std::vector<Labels> labels = labels_of_leaves(of.regions, of.state, 0.5f, one_thread);
  size_t wrong = 0, compared = 0;
  for (int l = 0; l < 2; ++l)
    for (size_t b = 0; b < labels[static_cast<size_t>(l)].grid.size(); ++b) {
      const Labels& own = labels[static_cast<size_t>(l)];
      if (!own.covers(own.grid.coord(b))) continue;
      for_each_vertex(own.grid.coord(b), [&](Vec3i v, int) {
        const double inside = Ball::ball(leaf_center(l, v));
        if (std::abs(inside) < std::ldexp(1.5, l) || std::abs(inside) > 30) return;
        ++compared;
        wrong += own.test(v) != (inside > 0);
      });
    }
  EXPECT_GT(compared, 100000u);
  EXPECT_LE(wrong, compared / 2000);
}

/// Bits do not depend on threads.
TEST(SolveLeaves, ThreadsDoNotMatter) {
  Ball one, many;
  const auto never = [](int) { return false; };
  solve_leaves(one.regions, one.state, {1, 20, 10}, one_thread, never);
  solve_leaves(many.regions, many.state, {1, 20, 10}, Context(3), never);
  for (size_t l = 0; l < 2; ++l)
    for (size_t b = 0; b < one.state[l].grid.size(); ++b) {
      ASSERT_TRUE(
          std::equal(one.state[l].u.brick(b), one.state[l].u.brick(b) + brick_volume, many.state[l].u.brick(b)));
      ASSERT_TRUE(
          std::equal(one.state[l].p.brick(b), one.state[l].p.brick(b) + 3 * brick_volume, many.state[l].p.brick(b)));
    }
}

/// Beyond its places a level's labels are on the sides of the coarser level's surface.
TEST(LeafLabels, GoOnInTheCoarserSurface) {
  const Ball of;
  Labels own;
  own.box = of.lattice.box(0);
  own.places = std::make_shared<const BrickMask>(children_of(of.regions.finer(1), own.box.bricks));
  own.grid = BrickGrid(*own.places, one_thread);
  own.inside = GapSides(BrickMask(own.box.bricks));
  own.bits.resize(own.grid.size());
  for (size_t b = 0; b < own.grid.size(); ++b)
    for_each_vertex(own.grid.coord(b), [&](Vec3i v, int i) {
      if (Ball::ball(leaf_center(0, v)) > 0) own.bits[b].set(i);
    });
  const DistanceField coarser = field_of(of.lattice, 1, Ball::ball);
  const Labels all = continued_beyond(own, coarser, one_thread);
  EXPECT_FALSE(all.places);
  size_t wrong = 0, beyond = 0;
  for (size_t b = 0; b < all.grid.size(); ++b)
    for_each_vertex(all.grid.coord(b), [&](Vec3i v, int) {
      const double inside = Ball::ball(leaf_center(0, v));
      wrong += all.test(v) != (inside > 0) && std::abs(inside) > 0.1;
      beyond += !own.covers(brick_of(v)) && inside > 0;
    });
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(beyond, 10000u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
