// The paper's numerics over the pyramid, next to the certified optimum.
#include "soapfilm/pyramid/sor_pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "soapfilm/core/random.h"
#include "soapfilm/solve/energy.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr double lambda = 0.01;
const Context one_thread(1);

struct Case {
  std::string name, shape;
  int resolution;
  double density;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name << " at " << c.resolution; }

class SorAndOptimum : public testing::TestWithParam<Case> {};

TEST_P(SorAndOptimum, NoStateBeatsTheDualBound) {
  const auto& [name, shape, resolution, density] = GetParam();
  const Problem problem = make_problem(sampled(shape, resolution, density), resolution);
  const Level optimum = solve(problem, lambda, 1e-5).finest;
  const double bound = evaluate_energy(optimum, {.threshold = {}, .certify = true}, one_thread).dual;

  for (const SorOrder order : {SorOrder::lexicographic, SorOrder::red_black}) {
    SorParams params;
    params.order = order;
    std::vector<SorLevelReport> reports;
    int states = 0;
    const Level level =
        solve_sor(problem.lattice, problem.support, lambda, params, one_thread, reports, [&](const SorState& state) {
          if (state.iterations % 10 != 0) return;
          const Level seen = sor_level(state.u, state.box, state.lambda, state.support, params, one_thread);
          const Energies relaxed = evaluate_energy(seen, {.threshold = {}, .certify = true}, one_thread);
          EXPECT_GE(relaxed.primal, relaxed.dual);
          if (state.box.level > 0) return;
          const Energies binary = evaluate_energy(seen, {.threshold = 0.5f, .certify = true}, one_thread);
          EXPECT_GE(relaxed.primal, bound);
          EXPECT_GE(binary.primal, bound);
          ++states;
        });
    EXPECT_GT(states, 0);
    ASSERT_EQ(reports.size(), 3u);
    for (size_t k = 0; k < reports.size(); ++k) EXPECT_EQ(reports[k].level, 2 - static_cast<int>(k));

    // How near it comes: to 1e-4 .. 2e-3 of the optimum, in energy; its own bound proves less.
    const Energies relaxed = evaluate_energy(level, {.threshold = {}, .certify = true}, one_thread);
    const Energies binary = evaluate_energy(level, {.threshold = 0.5f, .certify = true}, one_thread);
    EXPECT_LT(relaxed.primal - bound, 3e-3 * std::abs(bound));
    EXPECT_LT(binary.primal - bound, 3e-3 * std::abs(bound));
    EXPECT_LT(relaxed.relative_gap(lambda), 2e-2);
    // Nothing makes the energy fall at each iteration, but it rises little and ends at its lowest.
    const std::vector<double>& energy = reports.back().energy;
    for (size_t k = 5; k < energy.size(); ++k) EXPECT_LE(energy[k], energy[k - 1] + 5e-3 * std::abs(bound));
    EXPECT_LE(energy.back(), *std::min_element(energy.begin(), energy.end()) + 1e-5 * std::abs(bound));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SorAndOptimum,
                         testing::Values(Case{"torus", "torus", 48, 1}, Case{"part", "part", 64, 2},
                                         Case{"knot_Slow", "knot", 56, 1}),
                         [](const auto& c) { return c.param.name; });

TEST(SorPyramid, SavesIterationsAtTheFinestLevel) {
  const Problem problem = make_problem(sampled("torus", 64, 1), 64);
  SorParams params;
  params.max_iterations = 3000;
  const auto run = [&](int levels) {
    params.levels = levels;
    std::vector<SorLevelReport> reports;
    solve_sor(problem.lattice, problem.support, lambda, params, one_thread, reports);
    EXPECT_EQ(reports.size(), static_cast<size_t>(levels));
    return reports.back();
  };
  const SorLevelReport pyramid = run(3), from_zero = run(1);
  EXPECT_LT(pyramid.iterations, from_zero.iterations);
  EXPECT_NEAR(pyramid.energy.back(), from_zero.energy.back(), 1e-4 * std::abs(from_zero.energy.back()));
}

/// Why the diffusivity takes central differences: with the total variation's own forward ones the far side of a jump
/// has g = 1 / epsilon, each renewal tears the jump down and the iterations between build it up again.
TEST(SorPyramid, CyclesWithForwardDifferences) {
  const Problem problem = make_problem(sampled("torus", 48, 1), 48);
  SorParams params;
  params.gradient = SorGradient::forward;
  std::vector<SorLevelReport> reports;
  solve_sor(problem.lattice, problem.support, lambda, params, one_thread, reports);
  EXPECT_FALSE(reports.back().converged);
  const std::vector<double>& energy = reports.back().energy;
  const auto [lowest, highest] = std::minmax_element(energy.end() - 20, energy.end());
  EXPECT_GT(*highest - *lowest, 3e-3 * std::abs(*lowest));
}

TEST(ProlongDense, IsTrilinear) {
  Lattice lattice;
  lattice.size = {29, 22, 17};
  lattice.levels = 3;
  const LevelBox coarse_box = lattice.box(1), fine_box = lattice.box(0);
  DenseField<float> coarse(coarse_box);
  Random random(7);
  const auto for_each = [](const LevelBox& box, auto&& visit) {
    for (int z = box.free_lo.z; z <= box.free_hi.z; ++z)
      for (int y = box.free_lo.y; y <= box.free_hi.y; ++y)
        for (int x = box.free_lo.x; x <= box.free_hi.x; ++x) visit(Vec3i{x, y, z});
  };
  for_each(coarse_box, [&](Vec3i v) { coarse.at(v) = static_cast<float>(random.uniform()); });
  const DenseField<float> fine = prolong_dense(coarse, fine_box, Context(3));
  for_each(fine_box, [&](Vec3i v) {
    double expected = 0;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3i from;
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const bool far = (corner >> axis) & 1;
        from[axis] = (v[axis] >> 1) + (far ? 2 * (v[axis] & 1) - 1 : 0);
        weight *= far ? 0.25 : 0.75;
      }
      expected += weight * double{coarse.get(from)};
    }
    EXPECT_NEAR(fine.at(v), expected, 1e-6);
  });
  // Ones stay ones, to the bit: an empty run of the coarse level is one of the fine level's.
  for_each(coarse_box, [&](Vec3i v) { coarse.at(v) = 1; });
  const DenseField<float> ones = prolong_dense(coarse, fine_box, one_thread);
  for_each(fine_box, [&](Vec3i v) {
    const bool at_border = !coarse_box.is_free({(v.x >> 1) - 1, (v.y >> 1) - 1, (v.z >> 1) - 1}) ||
                           !coarse_box.is_free({(v.x >> 1) + 1, (v.y >> 1) + 1, (v.z >> 1) + 1});
    if (!at_border) {
      EXPECT_EQ(ones.at(v), 1);
    }
  });
}

}  // namespace TEST_FILE
}  // namespace soapfilm
