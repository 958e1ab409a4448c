#include "soapfilm/adapt/leaf_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adapt/ball_levels.h"
#include "soapfilm/adapt/level_samples.h"
#include "soapfilm/pyramid/restrict.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

const float* values_of(const SupportField& field, Vec3i brick) {
  const int32_t n = field.grid.find(brick);
  return n < 0 ? nullptr : field.f.brick(static_cast<size_t>(n));
}

bool is_zero(const float* f) {
  return !f || std::all_of(f, f + brick_volume, [](float v) { return v == 0; });
}

double sum_over(const SupportField& field, const std::function<bool(Vec3i)>& in, bool absolute) {
  double sum = 0;
  for (size_t b = 0; b < field.grid.size(); ++b)
    for (int i = 0; in(field.grid.coord(b)) && i < brick_volume; ++i) {
      const auto f = static_cast<double>(field.f.brick(b)[i]);
      sum += absolute ? std::abs(f) : f;
    }
  return sum;
}

/// A knot, half of it on level 0, half on level 1; `added`: its samples are on that level.
struct Halves {
  PointCloud cloud = sampled("knot", 100, 1);
  Problem problem = make_problem(cloud, place_lattice(cloud.box(), voxel_of_resolution(cloud.box(), 128, 16), 16));
  Lattice lattice;
  Regions regions;
  std::vector<SupportField> data, alone;  ///< of leaves; of all samples on each level

  explicit Halves(int added, int threads = 1) : lattice(problem.lattice.refined(added)) {
    const Context context(threads);
    const int middle = lattice.box(1).bricks.x / 2;
    regions = halves(lattice, middle, middle);
    data = data_of_leaves(problem.samples, regions, lattice, context);
    const LevelSamples placed{problem.samples, {}, {}};
    const LevelBox fine = lattice.box(0), coarse = lattice.box(1);
    const LevelSamples other = added == 0
                                   ? on_next_level(placed, coarse.bricks, context)
                                   : on_finer_level(placed, BrickMask::whole(coarse.bricks), fine.bricks, context);
    alone.push_back(divergence_field((added == 0 ? placed : other).samples, fine, context));
    alone.push_back(divergence_field((added == 0 ? other : placed).samples, coarse, context));
  }
  bool has(size_t l, Vec3i b) const { return regions.has(static_cast<int>(l), b); }
};

TEST(LeafData, IsThatOfEachLevelAwayFromItsBorder) {
  for (const int added : {0, 1}) {
    SCOPED_TRACE(added);
    const Halves h(added);
    for (size_t l = 0; l < 2; ++l) {
      size_t same = 0;
      for (size_t b = 0; b < h.alone[l].grid.size(); ++b) {
        const Vec3i at = h.alone[l].grid.coord(b);
        // A coarse sample reaches ten finer vertices.
        bool within = true;
        for (int slot = 0; slot < 27; ++slot)
          within = within && h.has(l, at + slot_offset(slot)) && (l == 1 || h.has(l, at + slot_offset(slot) * 2));
        if (!within) continue;
        const float *expected = h.alone[l].f.brick(b), *found = values_of(h.data[l], at);
        if (is_zero(expected)) continue;
        ASSERT_TRUE(found);
        EXPECT_TRUE(std::equal(expected, expected + brick_volume, found)) << at.x << ' ' << at.y << ' ' << at.z;
        ++same;
      }
      EXPECT_GT(same, 10u);
    }
  }
}

/// Each sample counts once: the sum over all leaves is 0, as on one level.
TEST(LeafData, SumsToZeroOverTheLeaves) {
  for (const int added : {0, 1}) {
    const Halves h(added);
    double sum = 0, size = 0;
    for (size_t l = 0; l < 2; ++l) {
      sum += sum_over(
          h.data[l], [&](Vec3i b) { return h.has(l, b); }, false);
      size += sum_over(
          h.data[l], [&](Vec3i b) { return h.has(l, b); }, true);
    }
    SCOPED_TRACE(added);
    EXPECT_GT(size, 1000);
    EXPECT_LT(std::abs(sum), 1e-6 * size);
    // Leaves alone do not: each level's own field would leave half a sample's data at the border.
    double apart = 0;
    for (size_t l = 0; l < 2; ++l)
      apart += sum_over(
          h.alone[l], [&](Vec3i b) { return h.has(l, b); }, false);
    EXPECT_GT(std::abs(apart), 1e-5 * size);
  }
}

TEST(LeafData, OfBricksWithFinerLeavesIsTheirSum) {
  const Halves h(0);
  const SupportField sums = restrict_field(h.data[0], h.lattice.box(1), one_thread);
  size_t finer = 0;
  for (size_t b = 0; b < sums.grid.size(); ++b) {
    if (!h.regions.is_finer(1, sums.grid.coord(b))) continue;
    const float* found = values_of(h.data[1], sums.grid.coord(b));
    ASSERT_TRUE(found);
    EXPECT_TRUE(std::equal(found, found + brick_volume, sums.f.brick(b)));
    ++finer;
  }
  EXPECT_GT(finer, 20u);
}

TEST(LeafData, ThreadsDoNotMatter) {
  const Halves one(1), many(1, 3);
  for (size_t l = 0; l < 2; ++l) {
    ASSERT_EQ(one.data[l].grid.size(), many.data[l].grid.size());
    for (size_t b = 0; b < one.data[l].grid.size(); ++b)
      EXPECT_TRUE(std::equal(one.data[l].f.brick(b), one.data[l].f.brick(b) + brick_volume, many.data[l].f.brick(b)));
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
