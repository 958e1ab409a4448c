#include "soapfilm/pyramid/band.h"

#include <gtest/gtest.h>

#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/pyramid/prolong.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// A coarse level without data, all bricks active, u = 0 and p = 0.
struct Blank {
  Lattice lattice;
  SupportField no_data;
  Level coarse;

  Blank() {
    lattice.size = {60, 60, 60};
    lattice.levels = 2;
    const LevelBox box = lattice.box(1);
    no_data.grid = BrickGrid(BrickMask(lattice.box(0).bricks), one_thread);
    coarse = make_level(box, 0.4f, BrickMask::whole(box.bricks), BrickGrid(BrickMask(box.bricks), one_thread),
                        no_data.f, one_thread);
  }
  float* u(Vec3i v) {
    const auto b = static_cast<size_t>(coarse.grid.find(brick_of(v)));
    return coarse.u.brick(b) + brick_offset(v.x & 7, v.y & 7, v.z & 7);
  }
  float* p(Vec3i v, int axis) {
    const auto b = static_cast<size_t>(coarse.grid.find(brick_of(v)));
    return coarse.p.brick(b, axis) + brick_offset(v.x & 7, v.y & 7, v.z & 7);
  }
  BrickMask children() const { return choose_band(coarse, lattice.box(0), no_data, 0, one_thread); }
};

TEST(Band, IsEmptyWhereNothingHappens) { EXPECT_EQ(Blank().children().count(), 0u); }

TEST(Band, HoldsBothSidesOfTheInterface) {
  Blank blank;
  *blank.u({12, 12, 12}) = 0.6f;
  const BrickMask band = blank.children();
  // The vertex is first in its octant: it and its lower neighbors' octants, across three faces.
  EXPECT_EQ(band.count(), 4u);
  for (const Vec3i v : {Vec3i{12, 12, 12}, {11, 12, 12}, {12, 11, 12}, {12, 12, 11}})
    EXPECT_TRUE(band.test(brick_of(v * 2)));
  *blank.u({12, 12, 12}) = 0.4f;
  EXPECT_EQ(blank.children().count(), 0u) << "u rounds to outside";
}

TEST(Band, HoldsTheOctantsOfEveryInterface) {
  Blank blank;
  Random random(1);
  std::vector<Vec3i> raised;
  for (int k = 0; k < 12; ++k) {
    const auto at = [&] { return static_cast<int>(random.next() % 24) + 3; };
    raised.push_back({at(), at(), at()});
    *blank.u(raised.back()) = 1;
  }
  BrickMask expected(blank.lattice.box(0).bricks);
  for (const Vec3i v : raised)
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        Vec3i next = v;
        next[axis] += step;
        if (*blank.u(next) > 0.5f) continue;
        expected.set(brick_of(v * 2));
        expected.set(brick_of(next * 2));
      }
  const BrickMask band = blank.children();
  EXPECT_EQ(band.count(), expected.count());
  expected.for_each([&](Vec3i b) { EXPECT_TRUE(band.test(b)) << b.x << " " << b.y << " " << b.z; });
}

TEST(Band, HoldsWhatTheProlongedDualMightLeave) {
  Blank blank;
  const float lambda = blank.coarse.lambda;
  *blank.p({12, 13, 14}, 0) = 0.8f * lambda;
  *blank.p({12, 13, 14}, 1) = 0.59f * lambda;
  EXPECT_EQ(blank.children().count(), 0u) << "the bound holds: sqrt(0.8^2 + 0.59^2) < 1";
  *blank.p({12, 12, 14}, 1) = 0.61f * lambda;  // the larger of two neighbors counts
  const BrickMask band = blank.children();
  EXPECT_EQ(band.count(), 1u);
  EXPECT_TRUE(band.test(brick_of(Vec3i{12, 13, 14} * 2)));
}

/// Outside the band the prolonged dual is feasible: the test on the coarse level is sufficient for the fine one.
TEST(Band, LeavesOutOnlyFeasibleBricks) {
  Blank blank;
  Random random(3);
  for (size_t b = 0; b < blank.coarse.grid.size(); ++b) {
    const double radius = random.uniform(0.3, 1.0) * blank.coarse.lambda;
    for (int i = 0; i < brick_volume; ++i)
      for (int axis = 0; axis < 3; ++axis)
        blank.coarse.p.brick(b, axis)[i] = static_cast<float>(radius * random.uniform(-0.7, 0.7));
  }
  const BrickMask band = blank.children();
  const BrickMask everywhere = BrickMask::whole(band.bricks());
  ASSERT_GT(band.count(), 0u);
  ASSERT_LT(band.count(), everywhere.count());
  const Level fine = prolong_level(blank.coarse, blank.lattice.box(0), everywhere, blank.no_data, one_thread);
  const DenseVectors p = dense_p(fine);
  p[0].for_each([&](Vec3i v) {
    if (band.test(brick_of(v))) return;
    ASSERT_LE(norm(vector_at(p, v)), fine.lambda * (1 + 1e-6));
  });
}

/// A grid of these bricks of a level's box.
BrickGrid grid_of(const LevelBox& box, const std::vector<Vec3i>& bricks) {
  BrickMask mask(box.bricks);
  for (const Vec3i b : bricks) mask.set(b);
  return BrickGrid(mask, one_thread);
}

/// A level that is solved whole has every free vertex and every face of one, and not what its box is rounded up by.
TEST(Band, OfAWholeLevelFollowsTheFreeVertices) {
  for (const Vec3i size : {Vec3i{60, 61, 62}, {1181, 220, 38}, {5000, 50, 50}, {64, 65, 200}}) {
    Lattice lattice;
    lattice.size = size;
    lattice.levels = 5;
    for (int l = 0; l < lattice.levels; ++l) {
      const LevelBox box = lattice.box(l);
      const BrickMask bricks = start_bricks(box, grid_of(box, {brick_of(box.free_lo)}), 1e9);
      double most = 1;
      for (int axis = 0; axis < 3; ++axis) {
        most *= (box.free_hi[axis] - box.free_lo[axis] + 3) / brick_side + 2;
        for (const Vec3i& end : {box.free_lo, box.free_hi})
          for (const int step : {-1, 0, 1}) {
            Vec3i v = end;
            v[axis] += step;
            ASSERT_TRUE(!bricks.contains(brick_of(v)) || bricks.test(brick_of(v)));
          }
      }
      EXPECT_LE(static_cast<double>(bricks.count()), most);
    }
  }
}

/// Far apart samples get blocks around them, as large as the limit allows, and never less than what is next to them.
TEST(Band, OfAStartFollowsTheDataInALargeBox) {
  Lattice lattice;
  lattice.size = {100000, 80000, 90000};
  lattice.levels = 3;
  const LevelBox box = lattice.box(0);
  const std::vector<Vec3i> data = {{100, 200, 300}, {101, 200, 300}, {9000, 8000, 11000}};
  const BrickGrid support = grid_of(box, data);
  for (const double most : {1.0, 16.0, 64.0, 1000.0, 1e5}) {
    const BrickMask bricks = start_bricks(box, support, most);
    for (const Vec3i at : data)
      for (int slot = 0; slot < 27; ++slot) ASSERT_TRUE(bricks.test(at + slot_offset(slot)));
    const auto count = static_cast<double>(bricks.count());
    EXPECT_LE(count, std::max({64.0, most * 3, 27.0 * 3}));
    if (most >= 64) {
      EXPECT_GE(8 * 8 * count, most * 3) << "blocks of twice the side were too many";
    }
  }
}

/// A hollow ball: as long as it is small beside the limit, what it encloses is there too, with a far sample as without.
TEST(Band, OfAStartHoldsWhatSamplesEnclose) {
  Lattice lattice;
  lattice.size = {4000, 4000, 4000};
  lattice.levels = 3;
  const LevelBox box = lattice.box(0);
  std::vector<Vec3i> data;
  const Vec3i center{20, 21, 22};
  BrickRange{{10, 10, 10}, {32, 32, 32}}.for_each([&](Vec3i b) {
    const double r = norm(Vec3d(b - center));
    if (r > 5 && r < 6) data.push_back(b);
  });
  data.push_back({400, 390, 300});
  const BrickMask bricks = start_bricks(box, grid_of(box, data), 16);
  BrickRange{{10, 10, 10}, {32, 32, 32}}.for_each(
      [&](Vec3i b) { EXPECT_TRUE(norm(Vec3d(b - center)) >= 6 || bricks.test(b)); });
}

TEST(Band, GrowsWhereTheInterfaceReachesTheRim) {
  Blank blank;
  BrickMask band(blank.lattice.box(0).bricks);
  band.set({3, 3, 3});
  Level fine = prolong_level(blank.coarse, blank.lattice.box(0), band, blank.no_data, one_thread);
  EXPECT_EQ(growth(fine, &blank.coarse.grid, Context(2)).count(), 0u);
  fine.u.brick(0)[brick_offset(7, 4, 4)] = 0.9f;
  fine.u.brick(0)[brick_offset(4, 4, 0)] = 0.9f;
  const BrickMask grown = growth(fine, &blank.coarse.grid, Context(2));
  EXPECT_EQ(grown.count(), 2u);
  EXPECT_TRUE(grown.test({4, 3, 3}));
  EXPECT_TRUE(grown.test({3, 3, 2}));
}

TEST(Band, WidensAcrossItsFacesWithinTheCoarseBand) {
  Blank blank;
  BrickMask parents(blank.coarse.box.bricks);
  parents.set({1, 1, 1});
  parents.set({2, 1, 1});
  const BrickGrid coarse(parents, one_thread);
  BrickMask band(blank.lattice.box(0).bricks);
  band.set({3, 3, 3});
  const BrickMask wide = widened(band, coarse);
  // Up y and up z lies the next parent, which the coarse band does not hold.
  EXPECT_EQ(wide.count(), 5u);
  for (const Vec3i brick : {Vec3i{3, 3, 3}, {2, 3, 3}, {4, 3, 3}, {3, 2, 3}, {3, 3, 2}}) EXPECT_TRUE(wide.test(brick));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
