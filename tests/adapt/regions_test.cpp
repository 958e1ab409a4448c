#include "soapfilm/adapt/regions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

constexpr int resolution = 200, levels = 4;

/// A knot's samples with spacings that somebody else knows: of the place, in voxels.
struct Known {
  Problem problem;
  LevelSamples samples;

  explicit Known(const auto& spacing) : problem(make_problem(sampled("knot", resolution, 0.5), resolution)) {
    samples.samples = problem.samples;
    for (const Vec3d q : lattice_positions(problem.samples)) samples.spacing.push_back(static_cast<float>(spacing(q)));
  }
  Regions regions(int threads = 1) const { return find_regions(samples, problem.lattice, levels, Context(threads)); }
};

/// The level of a place, by its brick of the finest level.
int level_of(const Regions& regions, Vec3i brick) {
  int level = 0;
  for (; !regions.has(level, brick); ++level) brick = parent_of(brick);
  return level;
}

TEST(Regions, AreOneWhereSamplesAreDense) {
  EXPECT_EQ(Known([](Vec3d) { return 1.9; }).regions().coarsest(), 0);
}

TEST(Regions, FollowTheSpacing) {
  const Known all_sparse([](Vec3d) { return 3.0; });
  const Regions regions = all_sparse.regions();
  EXPECT_EQ(regions.coarsest(), 1);
  const BrickGrid& bricks = all_sparse.samples.samples.bricks;
  for (size_t b = 0; b < bricks.size(); ++b) EXPECT_EQ(level_of(regions, bricks.coord(b)), 1);
}

/// From dense to sparse along x: levels differ by at most one from place to place, and nowhere is a place with samples
/// coarser than they ask for.
TEST(Regions, AreBalancedAndAsFineAsAskedFor) {
  const auto spacing = [](Vec3d q) { return std::exp2(q.x / 24 - 2); };
  const Known known(spacing);
  const Regions regions = known.regions();
  EXPECT_GE(regions.coarsest(), 3);
  const Vec3i box = known.problem.lattice.box(0).bricks;
  size_t coarser = 0;
  BrickRange::whole(box).for_each([&](Vec3i b) {
    const int own = level_of(regions, b);
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i n = b + slot_offset(slot); BrickRange::whole(box).contains(n)) {
        ASSERT_LE(std::abs(level_of(regions, n) - own), 1);
      }
  });
  const BrickGrid& bricks = known.samples.samples.bricks;
  for (size_t b = 0; b < bricks.size(); ++b) {
    const Vec3i at = bricks.coord(b);
    const int own = level_of(regions, at);
    if (own == 0) continue;
    ++coarser;
    // Even at the far end of what counts, two coarse bricks on, the finer level would be too fine.
    const double farthest = std::ldexp(2.0 * brick_side, own);
    EXPECT_GT(spacing(Vec3d(at) * double{brick_side} + Vec3d{farthest, 0, 0}), most_spacing * std::ldexp(1.0, own - 1))
        << at.x;
  }
  EXPECT_GT(coarser, bricks.size() / 4);
}

TEST(Regions, ThreadsDoNotMatter) {
  const Known known([](Vec3d q) { return std::exp2(q.x / 24 - 2); });
  const Regions one = known.regions(), many = known.regions(3);
  ASSERT_EQ(one.coarsest(), many.coarsest());
  for (int l = 1; l <= one.coarsest(); ++l) EXPECT_TRUE(one.finer(l) == many.finer(l));
}

/// Where nothing is known of the spacing, the number of samples tells: in a tree many, of a far wall few.
TEST(Regions, CountSamplesOfUnknownSpacing) {
  const auto unknown = [](Vec3d) { return 0.0; };
  const auto share_of_finest = [](const Known& known) {
    const Regions regions = known.regions();
    const GridSamples& all = known.samples.samples;
    size_t finest = 0;
    for (size_t b = 0; b < all.bricks.size(); ++b)
      if (level_of(regions, all.bricks.coord(b)) == 0) finest += all.begin[b + 1] - all.begin[b];
    return static_cast<double>(finest) / static_cast<double>(all.size());
  };
  EXPECT_GT(share_of_finest(Known(unknown)), 0.99);
  Known few(unknown);
  std::vector<uint32_t> taken, first = {0};
  const GridSamples& samples = few.samples.samples;
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; s += 16) taken.push_back(s);
    first.push_back(static_cast<uint32_t>(taken.size()));
  }
  few.samples.samples = samples.select(samples.bricks, first, taken, one_thread);
  few.samples.spacing.resize(taken.size());
  EXPECT_LT(share_of_finest(few), 0.1);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
