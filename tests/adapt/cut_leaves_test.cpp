#include "soapfilm/adapt/cut_leaves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "adapt/random_hierarchy.h"
#include "soapfilm/adapt/leaf_labels.h"
#include "soapfilm/adapt/leaf_links.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr double lambda = 0.05;

GraphCutSetup cut_setup(int neighbors) { return {neighbors, LinkWeights::edge_length, Norm::anisotropic}; }

/// A random hierarchy with data in a share of its leaf bricks, large enough for a surface.
struct CutProblem {
  Hierarchy h;

  CutProblem(uint64_t seed, double share) : h(seed, Norm::anisotropic, false) {
    for (int l = 0; l < levels; ++l) {
      SupportField& field = h.data[static_cast<size_t>(l)];
      for (size_t b = 0; b < field.grid.size(); ++b) {
        const bool has = h.regions.has(l, field.grid.coord(b)) && h.chance(share);
        const double mean = 1.5 * h.random.normal();
        for (int i = 0; i < brick_volume; ++i)
          field.f.brick(b)[i] =
              has ? static_cast<float>(std::ldexp(lambda * (mean + 2 * h.random.normal()), 2 * l)) : 0.0f;
      }
    }
  }

  std::vector<Level> cut(GraphCutReport& report, int neighbors, const Context& context = one_thread) const {
    const LeafCutSetup how{cut_setup(neighbors), lambda, {}};
    return *cut_leaves(h.regions, h.lattice, h.data, how, context, report);
  }
  Energies energies(const std::vector<Level>& state) const {
    std::vector<Labels> sides;
    for (const Level& level : state) sides.push_back(labels_of(level, 0.5f, one_thread));
    std::vector<LeafLevel> leaves;
    for (size_t l = 0; l < levels; ++l) leaves.push_back({&sides[l], &h.data[l], &state[l]});
    return evaluate_leaves(h.regions, leaves, 0, one_thread).energies;
  }
  double data(const LeafLinks& links, const Leaf& leaf) const {
    const SupportField& field = h.data[static_cast<size_t>(links.level(leaf.brick))];
    const int32_t n = field.grid.find(links.coord(leaf.brick));
    return n < 0 ? 0 : static_cast<double>(field.f.brick(static_cast<size_t>(n))[leaf.offset]);
  }
  LeafLinks links(int neighbors) const {
    return LeafLinks(h.regions, h.lattice, cut_setup(neighbors), lambda, one_thread);
  }
  /// The least energy, by one cut of all leaves.
  double least(int neighbors) const {
    const LeafLinks all = links(neighbors);
    const auto number = [](const Leaf& leaf) {
      return static_cast<uint32_t>(leaf.brick * brick_volume + static_cast<size_t>(leaf.offset));
    };
    double bound = 0;
    const auto describe = [&](const Leaf& leaf) {
      NetworkVertex vertex;
      const Vec3i v = vertex_in_brick(leaf.offset);
      if (!all.free(leaf.brick).test(v.x, v.y, v.z)) return vertex;
      vertex.unary = -data(all, leaf);
      all.for_each_link(leaf, [&](const Leaf* other, double weight) {
        if (!other)
          vertex.unary += weight;
        else if (leaf < *other)
          vertex.links.emplace_back(number(*other), weight);
      });
      return vertex;
    };
    const MinCut found = min_cut(
        number({all.bricks(), 0}),
        [&](const auto& visit) {
          bound = 0;
          for (size_t b = 0; b < all.bricks(); ++b)
            for (int i = 0; i < brick_volume; ++i) {
              const NetworkVertex vertex = describe({b, i});
              bound += std::max(0.0, -vertex.unary);
              visit(vertex);
            }
        },
        one_thread);
    return found.flow - bound;
  }
};

bool same(const std::vector<Level>& a, const std::vector<Level>& b) {
  for (size_t l = 0; l < a.size(); ++l) {
    if (a[l].grid.size() != b[l].grid.size()) return false;
    for (size_t k = 0; k < a[l].grid.size(); ++k)
      if (a[l].grid.coord(k) != b[l].grid.coord(k) ||
          !std::equal(a[l].u.brick(k), a[l].u.brick(k) + brick_volume, b[l].u.brick(k)))
        return false;
  }
  return true;
}

/// For any labels what their links cost is their energy: each link is there once, and has its weight.
TEST(LeafLinks, CostTheAreaOfLeaves) {
  for (uint64_t seed = 1; seed <= (sanitized ? 1 : 3); ++seed) {
    const CutProblem problem(seed, 1);
    const Hierarchy& h = problem.h;
    const LeafLinks links = problem.links(6);
    const auto u = [&](const Leaf& leaf) {
      const auto level = static_cast<size_t>(links.level(leaf.brick));
      return h.sides[level].test(links.coord(leaf.brick) * brick_side + vertex_in_brick(leaf.offset));
    };
    double energy = 0;
    for (size_t b = 0; b < links.bricks(); ++b)
      links.free(b).for_each([&](int i) {
        const Leaf leaf{b, i};
        if (u(leaf)) energy -= problem.data(links, leaf);
        links.for_each_link(leaf, [&](const Leaf* other, double weight) {
          if (!other)
            energy += u(leaf) ? weight : 0;
          else if (u(leaf) != u(*other))
            energy += weight / 2;  // from each end
        });
      });
    const Energies found = evaluate_leaves(h.regions, h.leaves(), 0, one_thread).energies;
    EXPECT_NEAR(energy, found.primal, 1e-6 * lambda * found.total_variation);
  }
}

/// No labels have a lower energy, though the graph has only leaves near the data at first; and it is that of
/// adapt/leaf_energy.h.
TEST(CutLeaves, IsTheOptimumOnAllLeaves) {
  int growths = 0;
  for (const double share : {1.0, 0.2, 0.05})
    for (uint64_t seed = 1; seed <= (sanitized ? 1 : 2); ++seed) {
      if (sanitized && share > 0.1) continue;
      SCOPED_TRACE(testing::Message() << "seed " << seed << " share " << share);
      const CutProblem problem(seed, share);
      GraphCutReport report;
      const Energies found = problem.energies(problem.cut(report, 6));
      const double scale = 1e-6 * lambda * found.total_variation;
      EXPECT_TRUE(report.globally_optimal);
      EXPECT_LT(found.primal, 0);
      EXPECT_NEAR(found.primal, report.energy, scale);
      EXPECT_NEAR(report.energy, problem.least(6), scale);
      growths += report.growths;
    }
  EXPECT_GT(growths, 0);
}

TEST(CutLeaves, IsTheOptimumWith26Neighbors) {
  const CutProblem problem(4, 0.1);
  GraphCutReport report;
  problem.cut(report, 26);
  EXPECT_TRUE(report.globally_optimal);
  EXPECT_LT(report.energy, 0);
  EXPECT_NEAR(report.energy, problem.least(26), 1e-6 * std::abs(report.energy));
}

TEST(CutLeaves, ThreadsDoNotMatter) {
  const CutProblem problem(5, 0.1);
  GraphCutReport one, many;
  EXPECT_TRUE(same(problem.cut(one, 6), problem.cut(many, 6, Context(3))));
  EXPECT_EQ(one.energy, many.energy);
  EXPECT_EQ(one.vertices, many.vertices);
}

/// In bricks with finer leaves a level has the side of most of them.
TEST(CutLeaves, LevelsHaveTheSidesOfFinerLeaves) {
  const CutProblem problem(6, 0.3);
  GraphCutReport report;
  const std::vector<Level> state = problem.cut(report, 6);
  const std::vector<Labels> sides = labels_of_leaves(problem.h.regions, state, 0.5f, one_thread);
  size_t inside = 0;
  for (size_t l = 1; l < levels; ++l)
    problem.h.regions.finer(static_cast<int>(l)).for_each([&](Vec3i b) {
      for_each_vertex(b, [&](Vec3i v, int) {
        int of_finer = 0;
        for (int k = 0; k < 8; ++k) of_finer += state[l - 1].u_at(v * 2 + octant_of(k)) > 0.5f;
        ASSERT_EQ(sides[l].test(v), of_finer >= 4) << l;
        inside += sides[l].test(v);
      });
    });
  EXPECT_GT(inside, 1000u);
}

TEST(CutLeaves, NothingWhereAGraphDoesNotFit) {
  const CutProblem problem(1, 0.05);
  std::vector<size_t> asked;
  LeafCutSetup how{cut_setup(6), lambda, {}};
  how.fits = [&](size_t leaves, uint64_t) {
    asked.push_back(leaves);
    return asked.size() < 2;
  };
  GraphCutReport report;
  EXPECT_FALSE(cut_leaves(problem.h.regions, problem.h.lattice, problem.h.data, how, one_thread, report));
  ASSERT_EQ(asked.size(), 2u);
  EXPECT_GT(asked[1], asked[0]);
}

/// A ball, a half of it on one level and a half on the next, from data near its surface.
TEST(CutLeaves, FindsABallAcrossLevels) {
  constexpr double radius = 40;
  const Lattice lattice = small_lattice();
  const Regions regions = halves(lattice, 5, 5);
  const auto ball = [&](Vec3d q) { return radius - norm(q - Vec3d{75, 64, 65}); };
  std::vector<SupportField> data(2);
  for (int l = 0; l < 2; ++l) {
    SupportField& field = data[static_cast<size_t>(l)];
    field.grid = BrickGrid(BrickMask::whole(lattice.box(l).bricks), one_thread);
    field.f = Field<float>(field.grid);
    for (size_t b = 0; b < field.grid.size(); ++b)
      for_each_vertex(field.grid.coord(b), [&](Vec3i v, int i) {
        const double inside = ball(leaf_center(l, v));
        if (std::abs(inside) < 4)
          field.f.brick(b)[i] = static_cast<float>(std::ldexp(std::clamp(inside / 2, -1.0, 1.0), 3 * l));
      });
  }
  for (const int neighbors : {6, 26}) {
    GraphCutReport report;
    const LeafCutSetup how{{neighbors, LinkWeights::edge_length, Norm::isotropic}, 1, {}};
    const std::vector<Level> state = *cut_leaves(regions, lattice, data, how, one_thread, report);
    double volume = 0;
    size_t wrong = 0;
    for (int l = 0; l < 2; ++l)
      BrickRange::whole(lattice.box(l).bricks).for_each([&](Vec3i b) {
        if (regions.has(l, b))
          for_each_vertex(b, [&](Vec3i v, int) {
            const bool inside = state[static_cast<size_t>(l)].u_at(v) > 0.5f;
            const double distance = ball(leaf_center(l, v));
            if (inside) volume += std::ldexp(1.0, 3 * l);
            wrong += std::abs(distance) > std::ldexp(1.0, l) && inside != (distance > 0);
          });
      });
    EXPECT_TRUE(report.globally_optimal);
    EXPECT_EQ(wrong, 0u) << neighbors;
    const double off = volume / (4 * std::numbers::pi * radius * radius) - radius / 3;
    EXPECT_LT(std::abs(off), 0.15) << neighbors;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
