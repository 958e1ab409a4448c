// With the anisotropic norm, tv and the cut are one problem: the coarea formula is exact.
#include <gtest/gtest.h>

#include "soapfilm/pyramid/critical_lambda.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/primal_dual.h"
#include "solve/cut_problems.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

struct Case {
  std::string shape;
  double density;
  double lambda;
  double noise_vox;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.shape << " with " << c.density << " samples per voxel^2, lambda " << c.lambda << ", noise " << c.noise_vox;
}

class CoareaFormula : public testing::TestWithParam<Case> {};

TEST_P(CoareaFormula, TvAndGraphCutReachTheSameEnergySlow) {
  const auto& [shape, density, lambda, noise_vox] = GetParam();
  PointCloud cloud = sampled(shape, 32, density);
  add_noise(cloud, noise_vox / 20, 5);
  const Problem problem = make_problem(cloud, 32);
  const Cut best = cut(problem, lambda, {.neighbors = 6, .norm = Norm::anisotropic});
  const double scale = std::abs(best.report.energy);
  ASSERT_LT(best.report.energy, 0);
  EXPECT_NEAR(evaluate_energy(best.level, {}, one_thread).primal, best.report.energy, 1e-6 * scale) << "one judge";

  const PyramidSolution tv = solve(problem, lambda, 1e-6, 1, Norm::anisotropic);
  EXPECT_NEAR(evaluate_energy(tv.finest, {}, one_thread).primal, best.report.energy, 1e-5 * scale);
  EXPECT_NEAR(evaluate_energy(tv.finest, {.threshold = 0.5f}, one_thread).primal, best.report.energy, 1e-5 * scale);

  // Without a band there is no outside with a dual of the coarser level: the gap itself becomes 0.
  Level whole =
      make_level(problem.lattice.box(0), static_cast<float>(lambda), BrickMask::whole(problem.lattice.box(0).bricks),
                 problem.support.grid, problem.support.f, one_thread, Norm::anisotropic);
  double last = 1;
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    PrimalDualParams params;
    params.tolerance = tolerance;
    params.max_iterations = 20000;
    EXPECT_TRUE(solve_primal_dual(whole, params, one_thread).converged);
    const Energies binary = evaluate_energy(whole, {.threshold = 0.5f, .certify = true}, one_thread);
    EXPECT_LE(binary.relative_gap(lambda), last);
    last = binary.relative_gap(lambda);
    EXPECT_LE(binary.dual, best.report.energy + 1e-6 * scale) << "the bound holds for the cut too";
  }
  EXPECT_LT(last, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Shapes, CoareaFormula,
                         testing::Values(Case{"sphere", 2, 0.02, 0}, Case{"torus", 1, 0.01, 0},
                                         Case{"part", 2, 0.01, 0}, Case{"knot", 2, 0.005, 0},
                                         Case{"sphere", 1, 0.01, 1}, Case{"sheets", 2, 0.02, 0.3}),
                         [](const auto& c) { return c.param.shape + std::to_string(c.index); });

TEST(CoareaFormula, HoldsForRandomDataSlow) {
  for (const uint64_t seed : {7, 8}) {
    Problem problem = tiny_problem({30, 30, 30}, seed);
    const double lambda = 0.4;
    const Cut best = cut(problem, lambda, {.neighbors = 6, .norm = Norm::anisotropic});
    Level whole =
        make_level(problem.lattice.box(0), static_cast<float>(lambda), BrickMask::whole(problem.lattice.box(0).bricks),
                   problem.support.grid, problem.support.f, one_thread, Norm::anisotropic);
    PrimalDualParams params;
    params.tolerance = 1e-6;
    params.max_iterations = 20000;
    EXPECT_TRUE(solve_primal_dual(whole, params, one_thread).converged);
    const double binary = evaluate_energy(whole, {.threshold = 0.5f}, one_thread).primal;
    EXPECT_NEAR(binary, best.report.energy, 1e-5 * std::abs(best.report.energy));
    EXPECT_GE(binary, best.report.energy * (1 + 1e-9));
  }
}

/// Above the largest lambda that keeps a surface for tv, the cut is empty too.
TEST(CoareaFormula, TheCutIsEmptyBeyondTheCriticalLambda) {
  const Problem problem = make_problem(sampled("sphere", 32, 0.5), 32);
  const double critical = critical_lambda(problem.lattice, problem.support, 1, one_thread, Norm::anisotropic);
  ASSERT_GT(critical, 0);
  const auto inside = [&](double lambda) {
    return count_inside(dense_labels(cut(problem, lambda, {.neighbors = 6, .norm = Norm::anisotropic}).level));
  };
  EXPECT_GT(inside(0.97 * critical), 1000u);
  EXPECT_EQ(inside(1.06 * critical), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
