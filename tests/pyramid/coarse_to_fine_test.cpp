// The band's solution against the solution on the whole grid.
#include "soapfilm/pyramid/coarse_to_fine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"
#include "soapfilm/surface/indicator.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);
constexpr double tolerance = 2e-6;

/// One level without a pyramid: every brick of the finest box is active.
Level dense_solution(const Problem& problem, double lambda, Norm norm) {
  const LevelBox box = problem.lattice.box(0);
  Level level = make_level(box, static_cast<float>(lambda), BrickMask::whole(box.bricks), problem.support.grid,
                           problem.support.f, one_thread, norm);
  PrimalDualParams params;
  params.tolerance = tolerance;
  params.max_iterations = 20000;
  EXPECT_TRUE(solve_primal_dual(level, params, one_thread).converged);
  return level;
}

BrickMask mask_of(const BrickGrid& grid) {
  BrickMask mask(grid.bricks());
  for (size_t b = 0; b < grid.size(); ++b) mask.set(grid.coord(b));
  return mask;
}

struct Case {
  std::string shape;
  double density;
  double lambda;
  Norm norm = Norm::isotropic;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.shape << " with " << c.density << " samples per voxel^2, lambda " << c.lambda
       << (c.norm == Norm::isotropic ? "" : ", anisotropic");
}

class BandAndWholeGrid : public testing::TestWithParam<Case> {};

TEST_P(BandAndWholeGrid, HaveTheSameSolution) {
  const auto& [shape, density, lambda, norm] = GetParam();
  const Problem problem = make_problem(sampled(shape, 64, density), 64);
  const PyramidSolution band = solve(problem, lambda, tolerance, 1, norm);
  const Level dense = dense_solution(problem, lambda, norm);
  ASSERT_LT(band.finest.grid.size(), dense.grid.size() / 2) << "the band is the whole grid";

  const Dense<uint8_t> labels = dense_labels(dense);
  EXPECT_GT(count_inside(labels), 1000u);
  // The anisotropic optimum is less unique: a step of the film may move along it at no cost.
  const double share = norm == Norm::isotropic ? 5e-5 : 2e-4;
  EXPECT_LE(static_cast<double>(count_differences(dense_labels(band.finest), labels)),
            share * problem.lattice.vertices());

  const Energies of_band = evaluate_energy(band.finest, {.threshold = {}, .certify = true}, one_thread);
  const Energies of_dense = evaluate_energy(dense, {.threshold = {}, .certify = true}, one_thread);
  EXPECT_NEAR(of_band.primal, of_dense.primal, 1e-5 * std::abs(of_dense.primal));
  EXPECT_LT(of_band.relative_gap(lambda), 1e-3);
  EXPECT_LE(of_band.dual, of_dense.primal);
  EXPECT_LE(of_dense.dual, of_band.primal);

  const Energies binary_band = evaluate_energy(band.finest, {.threshold = 0.5f, .certify = true}, one_thread);
  const Energies binary_dense = evaluate_energy(dense, {.threshold = 0.5f, .certify = true}, one_thread);
  // Vertices where the relaxed u is near 1/2 may fall to either side.
  EXPECT_NEAR(binary_band.primal, binary_dense.primal, 5e-5 * std::abs(binary_dense.primal));
}

INSTANTIATE_TEST_SUITE_P(Shapes, BandAndWholeGrid,
                         testing::Values(Case{"sphere", 1, 0.01}, Case{"sphere", 0.3, 0.008}, Case{"torus", 1, 0.02},
                                         Case{"part", 2, 0.01}, Case{"part", 1, 0.03}, Case{"knot", 1, 0.01},
                                         Case{"sheets", 1, 0.02}, Case{"sphere", 1, 0.01, Norm::anisotropic},
                                         Case{"part", 2, 0.01, Norm::anisotropic},
                                         Case{"knot", 1, 0.01, Norm::anisotropic}),
                         [](const auto& c) { return c.param.shape + std::to_string(c.index); });

TEST(CoarseToFine, ReportsEveryLevelCoarsestFirst) {
  const Problem problem = make_problem(sampled("sphere", 64, 1), 64);
  const PyramidSolution solution = solve(problem, 0.02, 1e-3);
  ASSERT_EQ(solution.reports.size(), static_cast<size_t>(problem.lattice.levels));
  for (size_t k = 0; k < solution.reports.size(); ++k) {
    const LevelReport& report = solution.reports[k];
    EXPECT_EQ(report.level, problem.lattice.levels - 1 - static_cast<int>(k));
    EXPECT_TRUE(report.converged);
    EXPECT_GT(report.iterations, 0);
    const double lambda = 0.02 * std::pow(4, report.level);
    EXPECT_EQ(report.tolerance, report.level == 0 ? 1e-3 : report.level == 1 ? 2e-3 : 3e-4);
    EXPECT_LE(report.energies.relative_gap_band(lambda), report.tolerance);
  }
  EXPECT_EQ(solution.reports.back().active_vertices, solution.finest.grid.vertices());
}

/// Levels whose data does not pay for the surface take less of lambda: they tell the first one that does where to
/// start, and change nothing else.
TEST(CoarseToFine, EmptyCoarseLevelsShowWhereToStart) {
  constexpr double lambda = 0.02, tolerance = 1e-4;
  const PointCloud cloud = sampled("knot", 128, 1);
  const auto problem = [&](int levels) {
    return make_problem(cloud, place_lattice(cloud.box(), voxel_of_resolution(cloud.box(), 128, 6), 6, levels));
  };
  const Problem deep = problem(6);
  const PyramidSolution guided = solve(deep, lambda, tolerance);
  const auto takes_all = [](const LevelReport& report) { return report.lambda_share == 1; };
  const auto start = std::find_if(guided.reports.begin(), guided.reports.end(), takes_all);
  ASSERT_NE(start, guided.reports.begin());
  ASSERT_NE(start, guided.reports.end());
  EXPECT_TRUE(std::all_of(start, guided.reports.end(), takes_all));
  for (auto report = guided.reports.begin(); report != start; ++report) {
    EXPECT_GE(report->lambda_share, 0.25);
    EXPECT_LT(report->lambda_share, (report + 1)->lambda_share) << "the coarser, the less";
    EXPECT_EQ(report->tolerance, 1e-2);
    EXPECT_LE(report->energies.relative_gap_band(lambda * report->lambda_share * std::pow(4, report->level)),
              report->tolerance);
  }

  const Problem shallow = problem(start->level + 1);
  const PyramidSolution alone = solve(shallow, lambda, tolerance);
  ASSERT_EQ(alone.reports.front().level, start->level);
  EXPECT_LT(start->iterations, 0.9 * alone.reports.front().iterations);
  for (const LevelReport* report : {&*start, &guided.reports.back()}) {
    const LevelReport& same = alone.reports[alone.reports.size() - 1 - static_cast<size_t>(report->level)];
    EXPECT_TRUE(report->converged && same.converged);
    EXPECT_NEAR(report->energies.primal, same.energies.primal, 0.5 * report->tolerance * std::abs(same.energies.dual))
        << "level " << report->level;
  }
  const auto inside = static_cast<double>(count_inside(dense_labels(alone.finest)));
  EXPECT_NEAR(static_cast<double>(count_inside(dense_labels(guided.finest))), inside, 1e-4 * inside);

  // Where no level's data pays the paper's three do without.
  constexpr double too_much = 2;
  EXPECT_EQ(solve(deep, too_much, 1e-2).reports.front().level, 2);
}

TEST(CoarseToFine, ShowsItsObserverEveryLevelAndEveryEvaluation) {
  const Problem problem = make_problem(sampled("torus", 64, 1), 64);
  PrimalDualParams params;
  params.check_every = 8;
  std::vector<int> levels, evaluations;
  Energies last;
  PyramidObserver observer;
  observer.solved = [&](const Level& level, const Lattice& of_level) {
    levels.push_back(level.box.level);
    const Lattice expected = problem.lattice.of_level(level.box.level);
    EXPECT_EQ(of_level.voxel, expected.voxel);
    EXPECT_EQ(of_level.first_vertex, expected.first_vertex);
    EXPECT_GT(count_inside(dense_labels(level)), 10u) << "it shows the solution";
    // u has not changed since the last evaluation.
    EXPECT_EQ(evaluate_energy(level, {}, one_thread).primal, last.primal);
  };
  observer.evaluated = [&](const Level&, int iterations, const Energies& energies) {
    if (evaluations.size() == levels.size()) evaluations.push_back(iterations);
    EXPECT_GE(iterations, evaluations.back()) << "they count through the growths of a level's band";
    evaluations.back() = iterations;
    last = energies;
  };
  const PyramidSolution watched =
      solve_coarse_to_fine(problem.lattice, problem.support, 0.02, params, one_thread, Norm::isotropic, observer);
  ASSERT_EQ(levels.size(), watched.reports.size());
  for (size_t k = 0; k < levels.size(); ++k) {
    EXPECT_EQ(levels[k], watched.reports[k].level) << "coarsest first";
    EXPECT_EQ(evaluations[k], watched.reports[k].iterations);
  }
  const PyramidSolution alone = solve_coarse_to_fine(problem.lattice, problem.support, 0.02, params, one_thread);
  EXPECT_EQ(evaluate_energy(alone.finest, {}, one_thread).primal, last.primal) << "watching changes nothing";
}

/// A rim must not fix a flux that the finer ball cannot carry on. Here, in the part's inner corner, one did: the band
/// answered with a void along its rim and never converged, until it is widened.
TEST(CoarseToFine, ConvergesWhereTheFluxMustTurnSlow) {
  const Problem problem = make_problem(sampled("part", 256, 2), 256);
  PrimalDualParams params;
  params.tolerance = 3e-4;
  params.max_iterations = 800;
  constexpr double lambda = 0.088;
  const PyramidSolution solution = solve_coarse_to_fine(problem.lattice, problem.support, lambda, params, one_thread);
  for (const LevelReport& report : solution.reports) EXPECT_TRUE(report.converged) << "level " << report.level;
  EXPECT_TRUE(std::any_of(solution.reports.begin(), solution.reports.end(), [](const LevelReport& report) {
    return report.band_growths > 0;
  })) << "the case tells nothing: no band was too tight";
  EXPECT_LT(solution.reports.back().energies.relative_gap(lambda), 5e-4);
}

/// The coarse level's state is gone when the finest band turns out too small, and is solved for again: the grown band's
/// rim and outside are those of the state that the first band came from. (With so few iterations the coarse film is not
/// where the fine one goes.)
TEST(CoarseToFine, AGrownFinestBandHasTheFluxOfTheCoarseLevel) {
  constexpr double lambda = 0.01;
  const Problem problem = make_problem(sampled("sphere", 64, 1), 64);
  PrimalDualParams params;
  params.max_iterations = 12;
  params.check_every = 2;
  params.tolerance = 0.05;  // the finest level is there before its iterations run out, and may grow
  Level coarse;
  int solved = 0;
  PyramidObserver observe;
  observe.solved = [&](const Level& level, const Lattice&) {
    ++solved;
    if (level.box.level != 1) return;
    coarse =
        make_level(level.box, level.lambda, mask_of(level.grid), problem.support.grid, problem.support.f, one_thread);
    std::copy_n(level.u.brick(0), level.grid.vertices(), coarse.u.brick(0));
    std::copy_n(level.p.brick(0), 3 * level.grid.vertices(), coarse.p.brick(0));
    for (size_t b = 0; b < level.grid.size(); ++b)
      for (int axis = 0; axis < 3; ++axis)
        if (const float* flux = level.rim.plane(b, axis)) std::copy_n(flux, brick_area, coarse.rim.plane(b, axis));
    coarse.inside = level.inside;
    coarse.outside = level.outside;
  };
  const PyramidSolution solution =
      solve_coarse_to_fine(problem.lattice, problem.support, lambda, params, one_thread, Norm::isotropic, observe);
  ASSERT_GT(solution.reports.back().band_growths, 0);
  EXPECT_EQ(static_cast<size_t>(solved), solution.reports.size()) << "each level is told of once";
  const Level& grown = solution.finest;
  const Level again = prolong_level(coarse, grown.box, mask_of(grown.grid), problem.support, one_thread);
  EXPECT_EQ(grown.outside.dual, again.outside.dual);
  EXPECT_EQ(grown.outside.gap, again.outside.gap);
  size_t faces = 0;
  for (size_t b = 0; b < grown.grid.size(); ++b)
    for (int axis = 0; axis < 3; ++axis) {
      const float *flux = grown.rim.plane(b, axis), *expected = again.rim.plane(b, axis);
      ASSERT_EQ(flux == nullptr, expected == nullptr);
      for (int k = 0; flux && k < brick_area; ++k, ++faces) ASSERT_EQ(flux[k], expected[k]);
    }
  EXPECT_GT(faces, 1000u);
}

/// A cloud without what lies beyond a plane across its longest side: `share` of its length.
PointCloud without_end(const PointCloud& cloud, double share) {
  const Box3d box = cloud.box();
  PointCloud rest;
  for (size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].x < box.hi.x - share * (box.hi.x - box.lo.x)) {
      rest.positions.push_back(cloud.positions[i]);
      rest.normals.push_back(cloud.normals[i]);
    }
  return rest;
}

TEST(CoarseToFine, TheLimitHoldsOverTheGrowthsOfABand) {
  const Problem problem = make_problem(without_end(sampled("sphere", 96, 1), 0.4), 96);
  int growths = 0;
  for (const int limit : {1, 15, 40, 140, 200}) {
    PrimalDualParams params;
    params.max_iterations = limit;
    params.tolerance = 1e-7;
    params.settle = false;
    for (const LevelReport& report :
         solve_coarse_to_fine(problem.lattice, problem.support, 0.04, params, one_thread).reports) {
      EXPECT_LE(report.iterations, limit) << "level " << report.level;
      EXPECT_EQ(report.converged, report.stop == Stop::converged);
      if (report.stop == Stop::limit) {
        EXPECT_EQ(report.iterations, limit);
      }
      growths += report.band_growths;
    }
  }
  EXPECT_GT(growths, 0) << "the case tells nothing: no band has grown";
}

/// Where samples are missing the relaxed gap goes on falling when no label has anything of it.
TEST(CoarseToFine, ALevelEndsWhenItsLabelsHaveSettled) {
  const Problem problem = make_problem(without_end(sampled("part", 96, 1), 0.3), 96);
  constexpr double lambda = 0.03;
  const auto solved = [&](bool settle, int threads) {
    PrimalDualParams params;
    params.settle = settle;
    params.tolerance = 1e-5;
    params.max_iterations = 20000;
    return solve_coarse_to_fine(problem.lattice, problem.support, lambda, params, Context(threads));
  };
  const PyramidSolution settled = solved(true, 1), exact = solved(false, 1);
  const LevelReport &ended = settled.reports.back(), &went_on = exact.reports.back();
  EXPECT_EQ(ended.stop, Stop::settled);
  EXPECT_FALSE(ended.converged);
  EXPECT_EQ(went_on.stop, Stop::converged);
  EXPECT_LT(ended.iterations, 0.7 * went_on.iterations);

  const Energies binary = evaluate_energy(settled.finest, {.threshold = 0.5f, .certify = true}, one_thread);
  const Energies best = evaluate_energy(exact.finest, {.threshold = 0.5f, .certify = true}, one_thread);
  EXPECT_NEAR(binary.primal, best.primal, 5e-4 * std::abs(best.primal));
  EXPECT_LT(binary.gap, 1.15 * best.gap);
  const size_t differences = count_differences(dense_labels(settled.finest), dense_labels(exact.finest));
  EXPECT_LE(static_cast<double>(differences), 0.03 * binary.total_variation) << "a surface 0.03 vertices away";

  const PyramidSolution threaded = solved(true, 3);
  EXPECT_EQ(threaded.reports.back().iterations, ended.iterations);
  EXPECT_EQ(threaded.reports.back().energies.gap, ended.energies.gap);
}

/// Rings on hilly ground, ever farther apart, as a spinning scanner sees them.
PointCloud rings() {
  PointCloud cloud;
  for (double radius = 0.05; radius < 1; radius *= 1.3)
    for (int i = 0; i < 720; ++i) {
      const double angle = i * M_PI / 360, x = radius * std::cos(angle), y = radius * std::sin(angle);
      cloud.positions.push_back({x, y, 0.1 * std::sin(7 * x) * std::cos(5 * y)});
      cloud.normals.push_back(Vec3f(
          normalized(Vec3d{-0.7 * std::cos(7 * x) * std::cos(5 * y), 0.5 * std::sin(7 * x) * std::sin(5 * y), 1})));
    }
  cloud.scans.push_back({"rings", 0, cloud.size(), {}, {}, {}});
  return cloud;
}

/// Of an open surface no coarse level takes more than its share of the work; what is proved holds all the same.
TEST(CoarseToFine, CoarseLevelsOfAnOpenSurfaceTakeABoundedShareOfTheWork) {
  const Problem problem = [] {
    const PointCloud cloud = rings();
    Lattice lattice = lattice_of(cloud, 200);
    lattice.open = true;
    return make_problem(cloud, lattice);
  }();
  const auto solved = [&](bool settle, int threads) {
    PrimalDualParams params;
    params.settle = settle;
    return solve_coarse_to_fine(problem.lattice, problem.support, 0.02, params, Context(threads));
  };
  const PyramidSolution bounded = solved(true, 1), all = solved(false, 1);
  size_t spent = 0;
  const double finest = 128.0 * static_cast<double>(problem.support.grid.vertices());
  for (const LevelReport& level : bounded.reports) {
    EXPECT_NE(level.stop, Stop::limit) << level.level;
    spent += level.stop == Stop::spent;
    if (level.level == 0) continue;
    constexpr int after_growth = 40;
    const auto vertices = static_cast<double>(level.active_vertices);
    const double share = level.level == 1 ? 2 : 0.5;
    EXPECT_LE(vertices * level.iterations, share * finest + after_growth * vertices) << level.level;
  }
  EXPECT_GT(spent, 0u);
  for (const LevelReport& level : all.reports) EXPECT_NE(level.stop, Stop::spent) << level.level;

  const Energies binary = evaluate_energy(bounded.finest, {.threshold = 0.5f, .certify = true}, one_thread);
  const Energies best = evaluate_energy(all.finest, {.threshold = 0.5f, .certify = true}, one_thread);
  EXPECT_LE(binary.dual, best.primal) << "a bound of any";
  EXPECT_LE(best.dual, binary.primal);
  EXPECT_LE(binary.primal, best.primal + 5e-3 * std::abs(best.primal));

  const PyramidSolution threaded = solved(true, 3);
  EXPECT_EQ(threaded.reports.back().iterations, bounded.reports.back().iterations);
  EXPECT_EQ(threaded.reports.back().energies.gap, bounded.reports.back().energies.gap);
}

/// A film needs lambda times its area from either side of the band. With less it can only tear, whatever the
/// iterations: the solver says so.
TEST(CoarseToFine, ASurfaceThatTheBandBoundaryCannotFeedEndsStalled) {
  const Problem problem = make_problem(without_end(sampled("sphere", 64, 1), 0.4), 64);
  PrimalDualParams params;
  params.max_iterations = 20000;
  constexpr double lambda = 0.05;
  const SupportField field = restrict_field(problem.support, problem.lattice.box(1), one_thread);
  Level coarse = make_level(problem.lattice.box(1), static_cast<float>(4 * lambda),
                            BrickMask::whole(problem.lattice.box(1).bricks), field.grid, field.f, one_thread);
  ASSERT_TRUE(solve_primal_dual(coarse, params, one_thread).converged);
  int iterations[2];
  for (const bool faded : {false, true}) {
    if (faded) scale_flux(coarse, 0.6f, one_thread);
    const LevelBox box = problem.lattice.box(0);
    Level level = prolong_level(coarse, box, choose_band(coarse, box, problem.support, 1e9, one_thread),
                                problem.support, one_thread);
    const PrimalDualReport report = solve_primal_dual(level, params, one_thread, {.late = true, .stalls = true});
    EXPECT_EQ(report.stop, faded ? Stop::stalled : Stop::converged);
    iterations[faded] = report.iterations;
  }
  EXPECT_LT(iterations[0], 100);
  EXPECT_LT(iterations[1], 1000);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
