#include "soapfilm/finish/trim_regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "soapfilm/core/vec.h"
#include "support/flat_sheet.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr uint32_t side = 40;

bool round_gap(Vec3d p) { return std::hypot(p.x - 20, p.y - 20) < 6; }

/// A sheet whose vertices in a region are made up.
struct Case {
  Mesh mesh = test::flat_sheet(side, {}, 1);
  TrimLevels levels;
  std::vector<uint32_t> crossings;
  TrimReport report;

  explicit Case(const std::function<bool(Vec3d)>& made_up) {
    for (const Vec3d& p : mesh.vertices) levels.level.push_back(made_up(p) ? 2 : 0.5);
    levels.unfaced.assign(mesh.vertices.size(), 0);
  }
  /// Marks a share of the region's vertices, evenly spread.
  void mark(std::vector<uint8_t>& column, double share) {
    column.assign(mesh.vertices.size(), 0);
    double due = 0;
    for (size_t v = 0; v < column.size(); ++v) {
      if (levels.level[v] <= 1 || (due += share) < 1) continue;
      column[v] = 1;
      due -= 1;
    }
  }
  /// Does the region go?
  bool goes(RegionRules rules = {.open = true, .distance = 3}) {
    const std::vector<double> before = levels.level;
    const bool cut = choose_regions(mesh, levels, crossings, rules, report);
    EXPECT_EQ(cut, report.removed > 0);
    EXPECT_EQ(report.removed + report.filled, 1u);
    for (size_t v = 0; v < before.size(); ++v)
      EXPECT_EQ(levels.level[v], before[v] > 1 && !cut ? 0 : before[v]) << "what stays is at level 0";
    return cut;
  }
};

TEST(TrimRegions, AGapInTheSurfaceStays) {
  EXPECT_FALSE(Case(round_gap).goes());
  EXPECT_TRUE(Case(round_gap).goes({.open = true, .holes = true, .distance = 3}));
  EXPECT_FALSE(Case(round_gap).goes({.open = false}));
}

TEST(TrimRegions, WhatReachesTheBorderGoesFromAnOpenSurface) {
  const auto corner = [](Vec3d p) { return p.x < 6 && p.y < 6; };
  EXPECT_TRUE(Case(corner).goes());
  EXPECT_FALSE(Case(corner).goes({.open = false}));
}

TEST(TrimRegions, AMembraneGoes) {
  const auto most = [](Vec3d p) { return std::hypot(p.x - 20, p.y - 20) < 15; };
  EXPECT_TRUE(Case(most).goes());
  EXPECT_TRUE(Case(most).goes({.open = false}));
}

/// By the largest distance across, not by the area: of a slot its length. The cut is made 3 from the samples.
TEST(TrimRegions, AskedForAWidthItAloneDecides) {
  const auto slot = [](Vec3d p) { return std::abs(p.x - 20) < 1.5 && std::abs(p.y - 20) < 12.5; };
  const auto skew = [](Vec3d p) { return std::abs(p.x - p.y) < 1.5 && std::abs(p.x - 20) < 8.5; };
  const double slot_width = std::hypot(2, 24) + 6, skew_width = std::hypot(17, 17) + 6;
  for (const bool open : {false, true}) {
    for (const double off : {-0.1, 0.1}) {
      EXPECT_EQ(Case(slot).goes({.open = open, .distance = 3, .widest = slot_width + off}), off < 0) << open;
      EXPECT_EQ(Case(skew).goes({.open = open, .distance = 3, .widest = skew_width + 10 * off}), off < 0) << open;
    }
    EXPECT_EQ(Case(round_gap).goes({.open = open, .distance = 3, .widest = 10.0}), true);
  }
  const auto corner = [](Vec3d p) { return p.x < 6 && p.y < 6; };
  EXPECT_TRUE(Case(corner).goes({.open = true, .distance = 3, .widest = 100.0})) << "no gap: the border";
}

TEST(TrimRegions, TheBackOfSomethingGoes) {
  for (const auto& [share, back] : {std::pair{0.3, false}, {0.7, true}}) {
    Case c(round_gap);
    c.mark(c.levels.unfaced, share);
    EXPECT_EQ(c.goes(), back) << share;
    EXPECT_EQ(c.report.unfaced, back ? 1u : 0u);
  }
}

TEST(TrimRegions, WhatManyRaysCrossedGoes) {
  for (const auto& [rays, gone] : {std::pair{3u, false}, {4u, true}}) {
    Case c(round_gap);
    c.crossings.assign(c.mesh.vertices.size(), 0);
    for (size_t v = 0; v < c.crossings.size(); ++v)
      if (c.mesh.vertices[v].x == 20 && c.mesh.vertices[v].y == 20) c.crossings[v] = rays;
    EXPECT_EQ(c.goes(), gone) << rays;
    EXPECT_EQ(c.report.crossed, gone ? 1u : 0u);
  }
}

TEST(TrimRegions, AWideGapIsWhereTheSurfaceEnds) {
  EXPECT_FALSE(Case(round_gap).goes({.open = true, .distance = 2.5}));
  EXPECT_TRUE(Case(round_gap).goes({.open = true, .distance = 1.5}));
}

/// A bag that hangs from its rim is no gap, a shallow dish is one.
TEST(TrimRegions, ABagGoesAndADishStays) {
  for (const auto& [deep, bag] : {std::pair{2.0, false}, {20.0, true}}) {
    Case c(round_gap);
    for (Vec3d& p : c.mesh.vertices) {
      const double r = std::hypot(p.x - 20, p.y - 20) / 6;
      if (r < 1) p.z = -deep * (1 - r * r);
    }
    EXPECT_EQ(c.goes(), bag) << deep;
  }
}

/// Along a fold between two walls the way across is no part of either.
TEST(TrimRegions, WhatLooksElsewhereThanItsRimGoes) {
  for (const bool flap : {false, true}) {
    Case c(round_gap);
    if (flap)
      for (Vec3d& p : c.mesh.vertices)
        if (round_gap(p)) p = {p.x, 20 + 0.05 * (p.y - 20), 1.5 * (p.y - 20)};
    EXPECT_EQ(c.goes(), flap);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
