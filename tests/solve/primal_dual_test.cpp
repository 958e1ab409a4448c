#include "soapfilm/solve/primal_dual.h"

#include <gtest/gtest.h>

#include "support/dense.h"
#include "support/hash.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Parallel one_thread(1);

/// The whole box as one level. `problem` must outlive it.
Level whole_box(const Problem& problem, double lambda) {
  const LevelBox box = problem.lattice.box(0);
  BrickMask everywhere(box.bricks);
  everywhere.fill(true);
  return make_level(box, static_cast<float>(lambda), everywhere, problem.support.grid, problem.support.f, one_thread);
}

class SmallSphere : public testing::TestWithParam<int> {};

TEST_P(SmallSphere, GapFallsToAMillionth) {
  const Problem problem = make_problem(sampled("sphere", GetParam(), 2), GetParam());
  Level level = whole_box(problem, 0.02);
  PrimalDualParams params;
  params.tolerance = 1e-6;
  params.max_iterations = 20000;
  params.check_every = 100;
  Progress progress;
  double last_gap = std::numeric_limits<double>::infinity();
  const PrimalDualReport report =
      solve_primal_dual(level, params, one_thread, progress, [&](int, const Energies& e) { last_gap = e.gap; });
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.energies.relative_gap(level.lambda), 1e-6);
  EXPECT_EQ(report.energies.gap, last_gap);
  EXPECT_LT(report.energies.primal, 0) << "a surface, not the empty set";

  const Energies certified = evaluate_energy(level, {.threshold = {}, .certify = true}, one_thread);
  EXPECT_LE(certified.dual, certified.primal);
  EXPECT_LE(certified.relative_gap(level.lambda), 2e-6);
}

INSTANTIATE_TEST_SUITE_P(Vertices, SmallSphere, testing::Values(24, 32));

TEST(PrimalDual, WithoutDataTheOptimumIsEmpty) {
  Problem problem = make_problem(sampled("sphere", 24, 1), 24);
  for (size_t b = 0; b < problem.support.f.bricks(); ++b) std::fill_n(problem.support.f.brick(b), brick_volume, 0.0f);
  Level level = whole_box(problem, 0.01);
  Progress progress;
  const PrimalDualReport report = solve_primal_dual(level, {}, one_thread, progress);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.energies.primal, 0);
  EXPECT_EQ(report.energies.dual, 0);
}

TEST(PrimalDual, SaysWhenTheIterationsRanOut) {
  const Problem problem = make_problem(sampled("sphere", 24, 2), 24);
  Level level = whole_box(problem, 0.02);
  PrimalDualParams params;
  params.tolerance = 1e-12;
  params.max_iterations = 40;
  Progress progress;
  const PrimalDualReport report = solve_primal_dual(level, params, one_thread, progress);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 40);
}

TEST(PrimalDual, ForeseesWhenTheGapIsSmallEnough) {
  const Problem problem = make_problem(sampled("sphere", 48, 2), 48);
  for (const bool late : {false, true})
    for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
      Level level = whole_box(problem, 0.02);
      PrimalDualParams params;
      params.tolerance = tolerance;
      params.late = late;
      Progress progress;
      int evaluations = 0;
      const PrimalDualReport report =
          solve_primal_dual(level, params, one_thread, progress, [&](int, const Energies&) { ++evaluations; });
      EXPECT_TRUE(report.converged);
      // A few more than the longest wait between two asks for.
      EXPECT_LE(evaluations, report.iterations / params.check_every + 5) << late << ' ' << tolerance;
    }
}

TEST(PrimalDual, EstimatesTellALargeLevelsGapOnAnyNumberOfThreads) {
  const Problem problem = make_problem(sampled("knot", 128, 1), 128);
  PrimalDualParams params;
  params.tolerance = 0.02;
  PrimalDualReport report[2];
  for (const bool estimate : {false, true}) {
    Level level = whole_box(problem, 0.05);
    ASSERT_GE(level.grid.size(), 4096u);
    params.estimate = estimate;
    Progress progress;
    int evaluations = 0;
    report[estimate] =
        solve_primal_dual(level, params, one_thread, progress, [&](int, const Energies&) { ++evaluations; });
    EXPECT_TRUE(report[estimate].converged);
    const double gap = report[estimate].energies.relative_gap_band(level.lambda);
    EXPECT_EQ(gap, evaluate_energy(level, {}, one_thread).relative_gap_band(level.lambda)) << "no estimate is reported";
    EXPECT_LE(gap, params.tolerance);
    const double estimated = estimate_gap(level, one_thread);
    EXPECT_NEAR(estimated, gap, 0.2 * gap);
    for (const int threads : {2, 3, 8}) EXPECT_EQ(estimate_gap(level, Parallel(threads)), estimated);
    if (estimate) {
      EXPECT_LE(evaluations, 3);
    }
  }
  EXPECT_NEAR(report[true].iterations, report[false].iterations, 0.2 * report[false].iterations);
}

TEST(PrimalDual, CancelsBeforeTheNextSweeps) {
  const Problem problem = make_problem(sampled("sphere", 24, 2), 24);
  Level level = whole_box(problem, 0.02);
  Progress progress;
  PrimalDualParams params;
  params.tolerance = 1e-12;
  EXPECT_THROW(solve_primal_dual(level, params, one_thread, progress, [&](int, const Energies&) { progress.cancel(); }),
               Cancelled);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
