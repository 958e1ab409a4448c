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
  const DistanceField levels[] = {field_of(lattice, 0, ball), field_of(lattice, 1, ball)};
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
  const DistanceField levels[] = {field_of(lattice, 0, cut), field_of(lattice, 1, ball)};
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

/// Samples two voxels off the surface are misfits unless they are far apart.
TEST(Agreement, MisfitsAreBricksWhoseSamplesAreOffTheSurface) {
  const Lattice lattice = small_lattice();
  const DistanceField coarse = field_of(lattice, 1, ball);
  const auto with_samples = [&](double off, float spacing) {
    LevelSamples level;
    BrickMask mask(lattice.box(1).bricks);
    const Vec3i brick{4, 4, 6};  // the top of the ball
    mask.set(brick);
    level.samples.bricks = BrickGrid(mask, one_thread);
    level.samples.begin = {0};
    for (int i = 0; i < 20; ++i) {
      const Vec3d fine{66.0 + i % 5, 66.0 + i / 5, 0};
      const double up = std::sqrt(std::pow(45 + off, 2) - std::pow(fine.x - 63, 2) - std::pow(fine.y - 64, 2));
      const Vec3d place = (Vec3d{fine.x, fine.y, 65 + up} - Vec3d{0.5, 0.5, 0.5}) / 2.0;
      level.samples.local.push_back(Vec3f(place - Vec3d(brick * brick_side)));
      level.spacing.push_back(spacing);
    }
    level.samples.begin.push_back(20);
    return level;
  };
  EXPECT_TRUE(misfits(with_samples(0, 1), 1, coarse, one_thread).empty());
  EXPECT_EQ(misfits(with_samples(-4, 1), 1, coarse, one_thread).size(), 1u);
  EXPECT_TRUE(misfits(with_samples(-4, 9), 1, coarse, one_thread).empty());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
