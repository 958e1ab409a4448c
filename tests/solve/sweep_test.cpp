#include "soapfilm/solve/sweep.h"

#include <gtest/gtest.h>

#include "support/back_ends.h"
#include "support/dense.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/random_level.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr StepSizes steps{.sigma = 0.14f, .tau = static_cast<float>(1 / (12 * 0.14))};

/// Chambolle and Pock's iteration (2011, algorithm 1) vertex by vertex, in double, on a dense copy of a level.
class Reference {
 public:
  explicit Reference(const Level& level) : level_(level), u_(dense_u(level)), f_(dense_f(level)), p_(dense_p(level)) {}

  void sweep() {
    Dense<double> u_bar(u_.size());
    for_each_active([&](Vec3i v) {
      if (!level_.box.is_free(v)) return;
      const double u = std::clamp(u_[v] - steps.tau * (adjoint_at(p_, v) - f_[v]), 0.0, 1.0);
      u_bar[v] = 2 * u - u_[v];
      u_[v] = u;
    });
    for_each_active([&](Vec3i v) { dual_step(v, gradient_at(u_bar, v)); });
  }

  const Dense<double>& u() const { return u_; }
  const DenseVectors& p() const { return p_; }

 private:
  template <class Visit>
  void for_each_active(Visit&& visit) {
    for (size_t b = 0; b < level_.grid.size(); ++b)
      for_each_vertex(level_.grid.coord(b), [&](Vec3i v, int) { visit(v); });
  }

  bool is_face(Vec3i v, int axis) const { return level_.box.is_free(v) && level_.box.is_free(v + along(axis)); }

  /// Projects the free components onto the part of the ball or the cube that the fixed ones leave.
  void dual_step(Vec3i v, Vec3d gradient) {
    double kept = 0, moved = 0;
    std::array<double, 3> q{};
    std::array<bool, 3> fixed{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      fixed[k] = level_.grid.find(brick_of(v + along(axis))) == outside_band || (level_.box.open && !is_face(v, axis));
      q[k] = p_[k][v] + steps.sigma * gradient[axis];
      (fixed[k] ? kept : moved) += fixed[k] ? p_[k][v] * p_[k][v] : q[k] * q[k];
    }
    const double radius = std::sqrt(std::max(0.0, double{level_.lambda} * level_.lambda - kept));
    const double scale = std::sqrt(moved) > radius ? radius / std::sqrt(moved) : 1.0;
    const double lambda = level_.lambda;
    for (size_t k = 0; k < 3; ++k)
      if (!fixed[k]) p_[k][v] = level_.norm == Norm::isotropic ? scale * q[k] : std::clamp(q[k], -lambda, lambda);
  }

  const Level& level_;
  Dense<double> u_, f_;
  DenseVectors p_;
};

void sweep(Level& level, int times, const Context& context) { Sweeper(level, context).sweep(steps, times); }

constexpr Norm both_norms[] = {Norm::isotropic, Norm::anisotropic};

class Sweep : public testing::TestWithParam<BackEnd> {
 protected:
  Context context = context_on(GetParam());
};

TEST_P(Sweep, IsTheIterationOfThePaper) {
  for (const Norm norm : both_norms)
    for (const bool open : {false, true}) {
      RandomLevel random(11, {.rim = open ? RimFlux::zero : RimFlux::random, .norm = norm, .open = open});
      Reference reference(random.level);
      for (int i = 0; i < 5; ++i) reference.sweep();
      sweep(random.level, 5, context);
      const Dense<double> u = dense_u(random.level);
      const DenseVectors p = dense_p(random.level);
      double worst = 0;
      u.for_each([&](Vec3i v) {
        worst = std::max(worst, std::abs(u[v] - reference.u()[v]));
        for (size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(p[k][v] - reference.p()[k][v]));
      });
      EXPECT_LT(worst, 1e-5);
      if (open) {
        EXPECT_EQ(flux_beyond_border(p, random.level.box), 0);
      }
    }
}

/// More sweeps at once than a tile holds, on a band with more rows of bricks than a tile, equal sweeps one by one.
TEST_P(Sweep, GivesTheSameBitsOnEveryBackEnd) {
  const Context one_thread(1);
  const Context scalar(1, "scalar");
  for (const Norm norm : both_norms)
    for (const bool open : {false, true}) {
      RandomLevel random(12, {.norm = norm, .open = open}), oracle(12, {.norm = norm, .open = open});
      sweep(random.level, 10, context);
      Sweeper one_by_one(oracle.level, scalar);
      for (int i = 0; i < 10; ++i) one_by_one.sweep(steps);
      EXPECT_EQ(hash_state(random.level), hash_state(oracle.level));
    }
}

/// A new sweeper steps every row. From zero, with data only in a shell, most rows are skipped at first.
TEST_P(Sweep, RowsThatRestLoseNothing) {
  constexpr int sweeps = 60;
  const Problem problem = make_problem(sampled("sphere", 40, 2), 40);
  const LevelBox box = problem.lattice.box(0);
  BrickMask band = BrickMask::whole(box.bricks);
  band.set({0, 0, 0}, false);
  band.set(box.bricks - Vec3i{1, 1, 1}, false);
  for (const Norm norm : both_norms) {
    Level resting = make_level(box, 0.02f, band, problem.support.grid, problem.support.f, context, norm);
    Level restless = make_level(box, 0.02f, band, problem.support.grid, problem.support.f, context, norm);
    Sweeper sweeper(resting, context);
    sweeper.sweep({}, 2);  // steps of length 0: every row is skipped, until other steps are used
    sweeper.sweep(steps, sweeps);
    for (int i = 0; i < sweeps; ++i) sweep(restless, 1, context);
    EXPECT_EQ(hash_state(resting), hash_state(restless));
    EXPECT_GT(count_inside(dense_labels(resting)), 1000u) << "the film has moved";
  }
}

TEST_P(Sweep, KeepsTheConstraints) {
  for (const Norm norm : both_norms) {
    RandomLevel random(13, {.rim = RimFlux::zero, .norm = norm});
    Level& level = random.level;
    sweep(level, 10, context);
    double longest = 0;
    for (size_t b = 0; b < level.grid.size(); ++b)
      for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
        const double u = level.u.brick(b)[i];
        const Vec3d p{level.p.brick(b, 0)[i], level.p.brick(b, 1)[i], level.p.brick(b, 2)[i]};
        ASSERT_TRUE(u >= 0 && u <= (level.box.is_free(v) ? 1 : 0)) << u;
        longest = std::max(longest, dual_length(p, norm));
      });
    EXPECT_LE(longest, level.lambda * (norm == Norm::isotropic ? 1 + 1e-6 : 1));
    EXPECT_GT(longest, level.lambda * 0.999);
  }
}

INSTANTIATE_TEST_SUITE_P(AllBackEnds, Sweep, testing::ValuesIn(back_ends()), back_end_name);

}  // namespace TEST_FILE
}  // namespace soapfilm
