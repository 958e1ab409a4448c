#include "soapfilm/adapt/agreement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adapt/ball_levels.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

double ball(Vec3d q) { return 45 - norm(q - Vec3d{63, 64, 65}); }

TEST(Agreement, NothingIsGivenBackWhereLevelsAgree) {
  const Lattice lattice = small_lattice();
  DistanceField levels[] = {field_of(lattice, 0, ball), field_of(lattice, 1, ball)};
  Regions regions = halves(lattice, 5, 2);
  give_back_disagreement(regions, levels, one_thread);
  EXPECT_TRUE(regions.finer(1) == halves(lattice, 5, 2).finer(1));
}

/// The finer level cuts the ball off from x = 40 on. What it has from the border on is given back as far as it is not
/// asked for; a dent away from the border, in front of which both agree, stays.
TEST(Agreement, FilmsAreGivenBackFromTheBorderOn) {
  const Lattice lattice = small_lattice();
  const auto dent = [](Vec3d q) { return norm(q - Vec3d{24, 64, 65}) - 12; };
  const auto cut = [&](Vec3d q) { return std::min({ball(q), 40 - q.x, dent(q)}); };
  DistanceField levels[] = {field_of(lattice, 0, cut), field_of(lattice, 1, ball)};
  Regions regions = halves(lattice, 5, 1);
  give_back_disagreement(regions, levels, one_thread);
  const Vec3i through{4, 4, 4}, at_film{2, 4, 4};
  EXPECT_FALSE(regions.is_finer(1, through));
  EXPECT_FALSE(regions.is_finer(1, at_film));
  EXPECT_TRUE(regions.is_finer(1, {0, 4, 4}));
  EXPECT_TRUE(regions.is_finer(1, {4, 0, 0}));  // outside on both

  Regions asked = halves(lattice, 5, 5);
  give_back_disagreement(asked, levels, one_thread);
  EXPECT_TRUE(asked.finer(1) == halves(lattice, 5, 5).finer(1));
}

/// Where finer levels need a level's places for the balance alone, and it disagrees with the coarser one, it gets that
/// one's distances: the places stay.
TEST(Agreement, WhatOnlyTheBalanceNeedsFollowsTheCoarserLevel) {
  const Lattice lattice = small_lattice();
  const auto cut = [&](Vec3d q) { return std::min(ball(q), 40 - q.x); };
  DistanceField levels[] = {field_of(lattice, 0, cut), field_of(lattice, 1, cut), field_of(lattice, 2, ball)};
  BrickMask finest(lattice.box(1).bricks), finer(lattice.box(2).bricks), wanted(lattice.box(2).bricks);
  finest.set({3, 4, 4});  // wants level 0: all around it level 1, at least
  BrickRange::whole(finer.bricks()).for_each([&](Vec3i b) { finer.set(b, b.x <= 2); });
  Regions regions({finest, finer}, {finest, wanted});
  const Vec3i needed{2, 2, 2}, free{2, 0, 0};
  ASSERT_TRUE(regions.is_asked(2, needed) && !regions.is_wanted(2, needed) && !regions.is_asked(2, free));
  give_back_disagreement(regions, levels, one_thread);
  EXPECT_TRUE(regions.is_finer(2, needed));
  // Vertex (x, y, z) of level 1 lies at 2 x + 1/2 of the finest one; beyond the cut the ball is there again.
  size_t compared = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3i child = child_of(needed, k);
    const int32_t b = levels[1].grid.find(child);
    ASSERT_GE(b, 0);
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = child * brick_side + vertex_in_brick(i);
      const double truth = ball(Vec3d(v) * 2.0 + Vec3d{0.5, 0.5, 0.5}) / 2;
      if (std::abs(truth) > 2) continue;
      EXPECT_NEAR(levels[1].value.brick(static_cast<size_t>(b))[i], truth, 0.3);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
