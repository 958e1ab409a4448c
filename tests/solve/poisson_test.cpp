#include "soapfilm/solve/poisson.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>

#include "soapfilm/error.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/surface/dense_surface.h"
#include "support/dense.h"
#include "support/problem.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

struct Solution {
  DenseField<float> u;
  PoissonReport report;
};

Solution solve(const Lattice& lattice, const SupportField& support, double lambda, double tolerance,
               const Context& context = one_thread) {
  Solution solution;
  solution.u = solve_poisson(lattice, support, lambda, {.tolerance = tolerance}, context, solution.report);
  return solution;
}

/// A lattice of `size` vertices along each axis, border included, and the data term value(vertex) at its free ones,
/// with vertices counted from the border.
template <class Value>
std::pair<Lattice, SupportField> data_everywhere(Vec3i size, Value&& value) {
  Lattice lattice;
  lattice.size = size;
  const LevelBox box = lattice.box(0);
  SupportField support{BrickGrid(BrickMask::whole(box.bricks), one_thread), {}};
  support.f = Field<float>(support.grid);
  for (size_t b = 0; b < support.grid.size(); ++b)
    for_each_vertex(support.grid.coord(b), [&](Vec3i v, int i) {
      if (box.is_free(v)) support.f.brick(b)[i] = static_cast<float>(value(v - box.free_lo + Vec3i{1, 1, 1}));
    });
  return {lattice, std::move(support)};
}

std::pair<Lattice, SupportField> random_data(Vec3i size, uint64_t seed) {
  Random random(seed);
  return data_everywhere(size, [&](Vec3i) { return random.normal(); });
}

/// g(t) = e^t sin(pi t), zero at 0 and 1, and its second derivative.
double bump(double t) { return std::exp(t) * std::sin(std::numbers::pi * t); }
double bump_curvature(double t) {
  constexpr double pi = std::numbers::pi;
  return std::exp(t) * ((1 - pi * pi) * std::sin(pi * t) + 2 * pi * std::cos(pi * t));
}

/// The largest error when u(x, y, z) = g(x / 5) g(y / 4) g(z / 3) is the solution, on a box of 5 x 4 x 3 and voxels of
/// 1 / cells.
double largest_error(int cells) {
  const Vec3i side = Vec3i{5, 4, 3} * cells;
  const double lambda = 0.3;
  const auto factor = [&](Vec3i v, int axis) { return bump(static_cast<double>(v[axis]) / side[axis]); };
  const auto curvature = [&](Vec3i v, int axis) {
    return bump_curvature(static_cast<double>(v[axis]) / side[axis]) / (side[axis] * side[axis]);
  };
  const auto [lattice, support] = data_everywhere(side + Vec3i{1, 1, 1}, [&](Vec3i v) {
    double laplacian = 0;
    for (int k = 0; k < 3; ++k) laplacian += curvature(v, k) * factor(v, (k + 1) % 3) * factor(v, (k + 2) % 3);
    return -2 * lambda * laplacian;
  });
  const Solution solution = solve(lattice, support, lambda, 1e-5);
  EXPECT_LT(solution.report.residual, 1e-4);
  double worst = 0;
  for (int z = 0; z <= side.z; ++z)
    for (int y = 0; y <= side.y; ++y)
      for (int x = 0; x <= side.x; ++x) {
        const Vec3i v{x, y, z};
        const double exact = factor(v, 0) * factor(v, 1) * factor(v, 2);
        worst = std::max(worst, std::abs(solution.u.at(solution.u.origin() + v) - exact));
      }
  return worst;
}

TEST(Poisson, AnalyticSolutionIsOfSecondOrderInTheVoxel) {
  const double coarse = largest_error(5), middle = largest_error(10), fine = largest_error(15);
  EXPECT_NEAR(std::log(coarse / middle) / std::log(2.0), 2, 0.1);
  EXPECT_NEAR(std::log(middle / fine) / std::log(1.5), 2, 0.1);
}

TEST(Poisson, ReportsResidualAndEnergyOfTheUItReturns) {
  const Problem problem = make_problem(sampled("torus", 50, 1), 50);
  const double lambda = 0.02;
  const LevelBox box = problem.lattice.box(0);
  const Dense<double> f = dense_field(problem.support, box);
  for (const double tolerance : {0.03, 1e-4}) {
    const Solution solution = solve(problem.lattice, problem.support, lambda, tolerance);
    const DenseField<float>& u = solution.u;
    const PoissonReport& report = solution.report;
    EXPECT_EQ(u.size(), problem.lattice.size);
    double squared = 0, data_squared = 0, energy = 0;
    size_t unknowns = 0;
    f.for_each([&](Vec3i v) {
      const double here = u.get(v);
      for (int k = 0; k < 3; ++k) energy += lambda * std::pow(u.get(v + along(k)) - here, 2);
      if (!box.is_free(v)) {
        EXPECT_EQ(here, 0);
        return;
      }
      ++unknowns;
      double flux = 0;
      for (int k = 0; k < 3; ++k) flux += 2 * here - u.get(v + along(k)) - u.get(v - along(k));
      squared += std::pow(f[v] - 2 * lambda * flux, 2);
      data_squared += f[v] * f[v];
      energy -= f[v] * here;
    });
    EXPECT_NEAR(report.residual, std::sqrt(squared / data_squared), 1e-3 * tolerance);
    EXPECT_LE(report.residual, tolerance);
    EXPECT_TRUE(report.converged);
    EXPECT_NEAR(report.energy, energy, 1e-6 * std::abs(energy));
    EXPECT_EQ(report.unknowns, unknowns);
    EXPECT_EQ(report.residuals.size(), static_cast<size_t>(report.iterations));
    EXPECT_NEAR(report.residuals.back(), report.residual, 0.1 * tolerance);
    EXPECT_LT(static_cast<double>(report.bytes), 18.5 * problem.lattice.vertices());
  }
}

TEST(Poisson, AnIterationReducesTheResidualFivefoldWhateverTheSize) {
  constexpr double tolerance = 1e-4;
  for (const Vec3i size : {Vec3i{17, 17, 17}, Vec3i{18, 23, 30}, Vec3i{65, 65, 65}, Vec3i{66, 67, 68},
                           Vec3i{129, 60, 35}, Vec3i{250, 20, 12}, Vec3i{5, 5, 150}, Vec3i{128, 129, 130}}) {
    const auto [lattice, support] = random_data(size, 1);
    const auto [u, report] = solve(lattice, support, 0.01, tolerance);
    const double rate = std::pow(report.residuals.back(), 1.0 / report.iterations);
    EXPECT_LT(rate, 0.2) << size.x << " x " << size.y << " x " << size.z;
    EXPECT_TRUE(report.converged);
  }
}

TEST(Poisson, NotConvergingIsReportedNotThrown) {
  const auto [lattice, support] = random_data({40, 40, 40}, 1);
  PoissonReport report;
  solve_poisson(lattice, support, 0.01, {.tolerance = 1e-4, .max_iterations = 2}, one_thread, report);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_FALSE(report.converged);
  EXPECT_GT(report.residual, 1e-4);
  // The resolution of float is reached long before this tolerance.
  solve_poisson(lattice, support, 0.01, {.tolerance = 1e-12, .max_iterations = 30}, one_thread, report);
  EXPECT_FALSE(report.converged);
  EXPECT_LT(report.residual, 1e-5);
}

TEST(Poisson, LambdaOnlyScalesU) {
  const Problem problem = make_problem(sampled("sphere", 40, 1), 40);
  const auto [u, report] = solve(problem.lattice, problem.support, 0.01, 1e-4);
  const auto [quarter, quarter_report] = solve(problem.lattice, problem.support, 0.04, 1e-4);
  EXPECT_EQ(report.iterations, quarter_report.iterations);
  float largest = 0;
  for (size_t i = 0; i < u.count(); ++i) largest = std::max(largest, u.data()[i]);
  for (size_t i = 0; i < u.count(); ++i) ASSERT_NEAR(u.data()[i], 4 * quarter.data()[i], 1e-5 * largest);
}

TEST(Poisson, WithoutDataUIsZero) {
  const auto [lattice, support] = data_everywhere({20, 21, 22}, [](Vec3i) { return 0.0; });
  const auto [u, report] = solve(lattice, support, 0.01, 1e-4);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(report.energy, 0);
  for (size_t i = 0; i < u.count(); ++i) ASSERT_EQ(u.data()[i], 0);
}

TEST(Poisson, RefusesParametersOutOfRange) {
  const auto data = random_data({12, 12, 12}, 1);
  PoissonReport report;
  const auto refused = [&](double lambda, const PoissonParams& params) {
    EXPECT_THROW(solve_poisson(data.first, data.second, lambda, params, one_thread, report), ParameterError);
  };
  refused(0, {});
  refused(-1, {});
  refused(std::nan(""), {});
  refused(0.1, {.tolerance = 0});
  refused(0.1, {.tolerance = 1});
  refused(0.1, {.max_iterations = 0});
}

TEST(Poisson, TheSameBytesForAnyNumberOfThreads) {
  constexpr int resolution = sanitized ? 44 : 70;
  const Problem problem = make_problem(sampled("knot", resolution, 1), resolution);
  const auto [u, report] = solve(problem.lattice, problem.support, 0.01, 1e-4);
  const double mean = mean_at_samples(u, problem.samples, one_thread);
  for (const int threads : {2, 3, 8}) {
    const Context context(threads);
    const auto [again, again_report] = solve(problem.lattice, problem.support, 0.01, 1e-4, context);
    EXPECT_EQ(std::memcmp(u.data(), again.data(), u.bytes()), 0) << threads;
    EXPECT_EQ(report.residual, again_report.residual);
    EXPECT_EQ(report.energy, again_report.energy);
    EXPECT_EQ(mean, mean_at_samples(again, problem.samples, context));
  }
}

class PoissonSurface : public testing::TestWithParam<std::string> {};

TEST_P(PoissonSurface, IsClosedWithTheShapesComponentsAndGenus) {
  const auto shape = make_shape(GetParam());
  const Problem problem = make_problem(sampled(*shape, 72, 2), 72);
  const auto [u, report] = solve(problem.lattice, problem.support, 0.01, 1e-4);
  const double isovalue = mean_at_samples(u, problem.samples, one_thread);
  const DenseSurface surface = dense_surface(u, isovalue, problem.lattice.box(0), one_thread);
  const Mesh mesh = extract_isosurface(
      surface.field.grid, surface.field.value, [&](Vec3i brick) { return surface.field.missing_value(brick); }, 0.5f,
      problem.lattice, one_thread);
  const TopologyReport topology = check_topology(mesh);
  EXPECT_TRUE(topology.watertight());
  EXPECT_EQ(topology.components.size(), static_cast<size_t>(shape->facts().components));
  EXPECT_EQ(topology.genus(), shape->facts().genus);
  double sum = 0;
  for (const Vec3d& vertex : mesh.vertices) sum += std::abs(shape->signed_distance(vertex));
  EXPECT_LT(sum / static_cast<double>(mesh.vertices.size()), 0.12 * problem.lattice.voxel);
}

INSTANTIATE_TEST_SUITE_P(Shapes, PoissonSurface, testing::Values("sphere", "torus", "knot"),
                         [](const auto& s) { return s.param; });

}  // namespace TEST_FILE
}  // namespace soapfilm
