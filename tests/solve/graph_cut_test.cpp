#include "soapfilm/solve/graph_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "soapfilm/error.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/solve/min_cut.h"
#include "soapfilm/surface/indicator.h"
#include "solve/cut_problems.h"
#include "support/dense.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// The discrete energy of labels on the whole box, link by link.
double energy_on_links(const Dense<double>& u, const Dense<double>& f, const std::vector<Link>& links) {
  double energy = 0;
  u.for_each([&](Vec3i v) {
    energy -= f[v] * u[v];
    for (const Link& link : links) energy += 0.5 * link.weight * std::abs(u[v] - u.get(v + link.step));
    for (const Link& link : links)
      if (!u.contains(v + link.step)) energy += 0.5 * link.weight * u[v];
  });
  return energy;
}

std::vector<GraphCutSetup> all_kinds() {
  std::vector<GraphCutSetup> all;
  for (const int neighbors : {6, 26})
    for (const LinkWeights weights : {LinkWeights::edge_length, LinkWeights::cauchy_crofton})
      for (const Norm norm : {Norm::isotropic, Norm::anisotropic}) all.push_back({neighbors, weights, norm});
  return all;
}

std::string name_of(const GraphCutSetup& p) {
  return "neighbors" + std::to_string(p.neighbors) +
         (p.weights == LinkWeights::edge_length ? "_edge_length" : "_cauchy_crofton") +
         (p.norm == Norm::isotropic ? "_isotropic" : "_anisotropic");
}

class EveryKind : public testing::TestWithParam<GraphCutSetup> {};
INSTANTIATE_TEST_SUITE_P(GraphCut, EveryKind, testing::ValuesIn(all_kinds()),
                         [](const auto& c) { return name_of(c.param); });

/// The lowest energy of all labelings, visited in the order of a Gray code: one label changes at a time.
double least_energy(const Problem& problem, const std::vector<Link>& links) {
  const LevelBox box = problem.lattice.box(0);
  const Dense<double> f = dense_field(problem.support, box);
  Dense<double> u(f.size());
  std::vector<Vec3i> free;
  u.for_each([&](Vec3i v) {
    if (box.is_free(v)) free.push_back(v);
  });
  double energy = 0, least = 0;
  for (uint32_t k = 1; k < (1u << free.size()); ++k) {
    const Vec3i v = free[static_cast<size_t>(std::countr_zero(k))];
    const double before = u[v], after = 1 - before;
    energy -= f[v] * (after - before);
    for (const Link& link : links) {
      const double other = u.get(v + link.step);
      energy += link.weight * (std::abs(after - other) - std::abs(before - other));
    }
    u[v] = after;
    least = std::min(least, energy);
  }
  return least;
}

TEST_P(EveryKind, FindsTheBestOfAllLabelingsOfTinyGrids) {
  for (const Vec3i free : {Vec3i{3, 3, 2}, {4, 2, 2}, {2, 2, 4}, {5, 3, 1}, {1, 1, 16}})
    for (const uint64_t seed : sanitized ? std::vector{1} : std::vector{1, 2, 3})
      for (const double lambda : {0.05, 0.3, 0.8}) {
        const Problem problem = tiny_problem(free, seed);
        const std::vector<Link> links = graph_links(GetParam(), lambda);
        const double least = least_energy(problem, links);
        const Cut best = cut(problem, lambda, GetParam());
        EXPECT_TRUE(best.report.globally_optimal);
        EXPECT_NEAR(best.report.energy, least, 1e-9);
        const Dense<double> f = dense_field(problem.support, best.level.box);
        EXPECT_NEAR(energy_on_links(dense_u(best.level), f, links), least, 1e-9) << "the labels returned";
      }
}

TEST_P(EveryKind, FlowIsTheEnergyLessItsLargestGain) {
  const Problem problem = tiny_problem({14, 13, 12}, 4);
  const Cut best = cut(problem, 0.2, GetParam());
  double largest_gain = 0;
  const BandGraph graph(VertexMask(best.level.box.bricks), best.level.box, problem.support,
                        graph_links(GetParam(), 0.2), one_thread);
  EXPECT_EQ(graph.vertices(), 0u);
  // -unary of each vertex: its f minus the links to fixed vertices.
  const std::vector<Link> links = graph_links(GetParam(), 0.2);
  const Dense<double> f = dense_field(problem.support, best.level.box);
  f.for_each([&](Vec3i v) {
    if (!best.level.box.is_free(v)) return;
    double gain = f[v];
    for (const Link& link : links)
      if (!best.level.box.is_free(v + link.step)) gain -= link.weight;
    largest_gain += std::max(0.0, gain);
  });
  EXPECT_NEAR(best.report.flow, best.report.energy + largest_gain, 1e-9 * largest_gain);
  EXPECT_LT(best.report.energy, 0);
}

/// Half a sphere: its inside and its outside are one part of the box, so the band must grow across the opening.
Problem half_sphere(int resolution) {
  PointCloud cloud = sampled("sphere", resolution, 2);
  PointCloud half;
  const double middle = (cloud.box().lo.z + cloud.box().hi.z) / 2;
  for (size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].z > middle) {
      half.positions.push_back(cloud.positions[i]);
      half.normals.push_back(cloud.normals[i]);
    }
  return make_problem(half, resolution);
}

/// The cut of the whole box, without a band.
double energy_on_the_whole_box(const Problem& problem, const std::vector<Link>& links) {
  const LevelBox box = problem.lattice.box(0);
  VertexMask all(box.bricks);
  for (int z = box.free_lo.z; z <= box.free_hi.z; ++z)
    for (int y = box.free_lo.y; y <= box.free_hi.y; ++y)
      for (int x = box.free_lo.x; x <= box.free_hi.x; ++x) all.set({x, y, z});
  const BandGraph graph(all, box, problem.support, links, one_thread);
  const MinCut best = min_cut(graph, one_thread);
  double gains = 0;
  BandGraph::Cursor cursor(graph);
  for (BandVertex v; cursor.next(v);) gains += std::max(0.0, -v.unary);
  return best.flow - gains;
}

TEST_P(EveryKind, BandGrowsUntilItsCutIsThatOfTheWholeBox) {
  const Problem problem = half_sphere(36);
  const double lambda = 0.02;
  const Cut best = cut(problem, lambda, GetParam());
  EXPECT_GT(best.report.growths, 0);
  EXPECT_TRUE(best.report.globally_optimal);
  EXPECT_LT(best.report.energy, -1);
  const std::vector<Link> links = graph_links(GetParam(), lambda);
  const double whole = energy_on_the_whole_box(problem, links);
  EXPECT_NEAR(best.report.energy, whole, 1e-9 * std::abs(whole));
  EXPECT_LT(static_cast<double>(best.report.vertices), 0.7 * problem.lattice.vertices());
  const double of_labels = energy_on_links(dense_u(best.level), dense_f(best.level), links);
  EXPECT_NEAR(of_labels, best.report.energy, 1e-9 * std::abs(whole));
}

TEST_P(EveryKind, RimsOfAClosedShapeAgreeAtOnce) {
  const Problem problem = make_problem(sampled("torus", 64, 2), 64);
  const Cut best = cut(problem, 0.02, GetParam());
  EXPECT_EQ(best.report.growths, 0);
  EXPECT_TRUE(best.report.globally_optimal);
  const std::vector<Link> links = graph_links(GetParam(), 0.02);
  EXPECT_NEAR(energy_on_links(dense_u(best.level), dense_f(best.level), links), best.report.energy,
              1e-9 * std::abs(best.report.energy));

  // Used by the stages after the solve.
  const IndicatorField surface = smoothed_indicator(labels_of(best.level, 0.5f, one_thread), one_thread);
  const Mesh mesh = extract_isosurface(
      surface.grid, surface.value, [&](Vec3i brick) { return surface.missing_value(brick); }, 0.5f, problem.lattice,
      one_thread);
  const TopologyReport topology = check_topology(mesh);
  EXPECT_TRUE(topology.watertight());
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 1);
}

TEST_P(EveryKind, WithoutDataTheOptimumIsEmpty) {
  Problem problem = tiny_problem({14, 13, 12}, 5);
  std::fill_n(problem.support.f.brick(0), problem.support.grid.vertices(), 0.0f);
  const Cut best = cut(problem, 0.1, GetParam());
  EXPECT_EQ(best.report.vertices, 0u);
  EXPECT_EQ(best.report.energy, 0);
  EXPECT_TRUE(best.report.globally_optimal);
  EXPECT_EQ(count_inside(dense_labels(best.level)), 0u);
}

TEST_P(EveryKind, DoesNotDependOnThreads) {
  const Problem problem = half_sphere(36);
  const auto fingerprint = [&](int threads) {
    const Cut best = cut(problem, 0.02, GetParam(), threads);
    uint64_t hash = hash_bytes(std::span<const double>(&best.report.energy, 1));
    for (size_t b = 0; b < best.level.grid.size(); ++b)
      hash = hash_bytes(std::span<const float>(best.level.u.brick(b), brick_volume), hash);
    return hash;
  };
  EXPECT_EQ(fingerprint(1), fingerprint(4));
}

/// Both outside and inside at once: the optimum fills the box up to its fixed layer.
TEST_P(EveryKind, SurfaceMayLieOnTheBorder) {
  Problem problem = tiny_problem({14, 13, 12}, 6);
  const LevelBox box = problem.lattice.box(0);
  for (size_t b = 0; b < problem.support.grid.size(); ++b)
    for_each_vertex(problem.support.grid.coord(b), [&](Vec3i v, int i) {
      problem.support.f.brick(b)[i] = v == box.free_lo + Vec3i{6, 6, 6} ? 1e4f : 0.1f * (v.x > 2);
    });
  const Cut best = cut(problem, 0.01, GetParam());
  const std::vector<Link> links = graph_links(GetParam(), 0.01);
  EXPECT_NEAR(best.report.energy, energy_on_the_whole_box(problem, links), 1e-6);
  EXPECT_GT(count_inside(dense_labels(best.level)), 2000u);
}

/// A plane of samples from border to border: no vertex that is free joins its two sides, but the fixed ones do.
TEST_P(EveryKind, SidesThatOnlyTheBorderJoinsAreCutApart) {
  Problem problem = tiny_problem({14, 13, 12}, 6);
  const LevelBox box = problem.lattice.box(0);
  for (const int places : {1, 2})  // the second time there are two such planes, and a layer between them
    for (const float sign : {1.0f, -1.0f}) {
      for (size_t b = 0; b < problem.support.grid.size(); ++b)
        for_each_vertex(problem.support.grid.coord(b), [&](Vec3i v, int i) {
          const int x = v.x - box.free_lo.x, at = places == 2 && x > 6 ? x - 6 : x;
          problem.support.f.brick(b)[i] = at == 3 ? sign : at == 4 ? -sign : 0.0f;
        });
      for (const double lambda : {0.01, 0.3}) {
        const Cut best = cut(problem, lambda, GetParam());
        const std::vector<Link> links = graph_links(GetParam(), lambda);
        EXPECT_TRUE(best.report.globally_optimal);
        EXPECT_NEAR(best.report.energy, energy_on_the_whole_box(problem, links), 1e-6);
        const double of_labels = energy_on_links(dense_u(best.level), dense_f(best.level), links);
        EXPECT_NEAR(of_labels, best.report.energy, 1e-6);
      }
    }
}

// --- What a plane costs. --------------------------------------------------------------------------------------------

/// Cost of a unit area with this unit normal: each vertex has one link of each kind, cut over |normal . step|.
double plane_cost(const std::vector<Link>& links, Vec3d normal) {
  double cost = 0;
  for (const Link& link : links) cost += 0.5 * link.weight * std::abs(dot(normal, Vec3d(link.step)));
  return cost;
}

struct Spread {
  double mean = 0, least = 1e300, most = 0;
  double deviation = 0;  ///< root mean square, relative to the mean
};

Spread spread_over_directions(const GraphCutSetup& params, double lambda) {
  const std::vector<Link> links = graph_links(params, lambda);
  Random random(1);
  Spread spread;
  double squares = 0;
  constexpr int directions = sanitized ? 50000 : 200000;
  for (int i = 0; i < directions; ++i) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    const double cost = plane_cost(links, normalized(Vec3d{x, y, z}));
    spread.mean += cost / directions;
    squares += cost * cost / directions;
    spread.least = std::min(spread.least, cost);
    spread.most = std::max(spread.most, cost);
  }
  spread.deviation = std::sqrt(squares / (spread.mean * spread.mean) - 1);
  return spread;
}

TEST_P(EveryKind, MeanCostOfAUnitAreaIsLambda) {
  for (const double lambda : {0.01, 1.0}) {
    const Spread spread = spread_over_directions(GetParam(), lambda);
    EXPECT_NEAR(spread.mean, lambda * (GetParam().norm == Norm::isotropic ? 1.0 : 1.5), 2e-3 * lambda);
  }
}

TEST(LinkWeights, OfSixNeighbors) {
  for (const LinkWeights weights : {LinkWeights::edge_length, LinkWeights::cauchy_crofton}) {
    for (const Link& link : graph_links({6, weights, Norm::isotropic}, 0.03)) EXPECT_NEAR(link.weight, 0.02, 1e-15);
    for (const Link& link : graph_links({6, weights, Norm::anisotropic}, 0.03)) EXPECT_NEAR(link.weight, 0.03, 1e-15);
  }
}

TEST(LinkWeights, OfTwentySixNeighborsDependLessOnTheDirection) {
  const Spread six = spread_over_directions({6, LinkWeights::edge_length, Norm::isotropic}, 1);
  const Spread by_length = spread_over_directions({26, LinkWeights::edge_length, Norm::isotropic}, 1);
  const Spread by_angle = spread_over_directions({26, LinkWeights::cauchy_crofton, Norm::isotropic}, 1);
  EXPECT_NEAR(six.most / six.least, std::sqrt(3.0), 0.01);
  EXPECT_NEAR(by_length.most / by_length.least, 1.103, 0.003);
  EXPECT_NEAR(by_angle.most / by_angle.least, 1.103, 0.003);
  EXPECT_NEAR(six.deviation, 0.1015, 0.001);
  EXPECT_NEAR(by_length.deviation, 0.0178, 0.0003);
  EXPECT_NEAR(by_angle.deviation, 0.0162, 0.0003);
}

/// Cauchy-Crofton: a link's weight times its length is the share of the directions that are nearest to it.
TEST(LinkWeights, OfCauchyCroftonAreSolidAngles) {
  const std::vector<Link> links = graph_links({26, LinkWeights::cauchy_crofton, Norm::isotropic}, 1);
  std::vector<double> share(links.size());
  Random random(2);
  constexpr int directions = 400000;
  for (int i = 0; i < directions; ++i) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    size_t nearest = 0;
    double best = -1;
    for (size_t d = 0; d < links.size(); ++d) {
      const double cosine = dot(normalized(Vec3d(links[d].step)), Vec3d{x, y, z});
      if (cosine > best) {
        best = cosine;
        nearest = d;
      }
    }
    share[nearest] += 1.0 / directions;
  }
  double sum = 0;
  for (const Link& link : links) sum += link.weight * norm(Vec3d(link.step));
  for (size_t d = 0; d < links.size(); ++d)
    EXPECT_NEAR(links[d].weight * norm(Vec3d(links[d].step)) / sum, share[d], 1.5e-3);
}

TEST(LinkWeights, ComeWithTheOppositeAtTheOtherEnd) {
  for (const GraphCutSetup& params : all_kinds()) {
    const std::vector<Link> links = graph_links(params, 1);
    ASSERT_EQ(links.size(), static_cast<size_t>(params.neighbors));
    for (size_t d = 0; d < links.size(); ++d) {
      EXPECT_EQ(links[links.size() - 1 - d].step, -links[d].step);
      EXPECT_EQ(links[links.size() - 1 - d].weight, links[d].weight);
    }
  }
}

TEST(GraphCut, RefusesBadParameters) {
  EXPECT_THROW(graph_links({18, LinkWeights::edge_length, Norm::isotropic}, 1), ParameterError);
  EXPECT_THROW(graph_links({}, 0), ParameterError);
  EXPECT_THROW(graph_links({}, std::nan("")), ParameterError);
}

TEST(GraphCut, TellsEachGraphBeforeItIsMade) {
  const Problem problem = make_problem(sampled("torus", 96, 0.05), 96);
  GraphCutReport report;
  std::vector<size_t> told;
  const auto tell = [&](size_t vertices) { told.push_back(vertices); };
  solve_graph_cut(problem.lattice, problem.support, 0.002, {}, Context(1), report, tell);
  ASSERT_EQ(told.size(), static_cast<size_t>(report.growths) + 1);
  EXPECT_EQ(told.back(), report.vertices);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  const auto refuse = [](size_t) { throw MemoryError("too many"); };
  EXPECT_THROW(solve_graph_cut(problem.lattice, problem.support, 0.002, {}, Context(1), report, refuse), MemoryError);
}

TEST(GraphCut, CanBeCancelledWithinTheCut) {
  struct CancelOnDetail : Progress {
    void detail(const std::string&) override { cancel(); }
  } progress;
  const Problem problem = make_problem(sampled("torus", 96, 2), 96);
  GraphCutReport report;
  EXPECT_THROW(solve_graph_cut(problem.lattice, problem.support, 0.02, {}, Context(1, progress), report), Cancelled);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
