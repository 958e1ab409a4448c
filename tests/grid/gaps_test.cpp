#include "soapfilm/grid/gaps.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

const Context one_thread(1);

/// Bricks of whole and of thinned-out rows and slices.
BrickGrid random_grid(Vec3i box, uint64_t seed) {
  Random random(seed);
  const double share = random.uniform(), rows = random.uniform(), slices = random.uniform();
  BrickMask mask(box);
  for (int z = 0; z < box.z; ++z) {
    if (random.uniform() > slices) continue;
    for (int y = 0; y < box.y; ++y) {
      if (random.uniform() > rows) continue;
      for (int x = 0; x < box.x; ++x)
        if (random.uniform() < share) mask.set({x, y, z});
    }
  }
  return BrickGrid(mask, one_thread);
}

class RandomGaps : public testing::TestWithParam<uint64_t> {
 protected:
  const Vec3i box{9, 7, 8};
  const BrickGrid grid = random_grid(box, GetParam());
  const Gaps gaps{grid};
};

TEST_P(RandomGaps, HoldEveryMissingBrickOnce) {
  ASSERT_EQ(gaps.size(), grid.gaps());
  std::set<size_t> met;
  double bricks = 0;
  size_t last = 0;
  BrickRange::whole(box).for_each([&](Vec3i b) {
    if (grid.find(b) >= 0) return;
    const size_t gap = grid.gap(b);
    ASSERT_LT(gap, gaps.size());
    EXPECT_TRUE(gaps[gap].contains(b));
    if (met.insert(gap).second) {
      EXPECT_EQ(gaps[gap].lo, b) << "it is met at its first brick";
      EXPECT_TRUE(met.size() == 1 || gap > last) << "in order";
      last = gap;
      bricks += gaps[gap].count();
    }
  });
  EXPECT_EQ(bricks + static_cast<double>(grid.size()), BrickRange::whole(box).count());
  for (size_t gap = 0; gap < gaps.size(); ++gap) EXPECT_EQ(gaps[gap].empty(), met.count(gap) == 0);
}

TEST_P(RandomGaps, TouchWhereTheirBricksDo) {
  std::set<std::pair<size_t, size_t>> expected, found;
  std::map<std::pair<size_t, size_t>, double> faces;
  BrickRange::whole(box).for_each([&](Vec3i b) {
    if (grid.find(b) >= 0) return;
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i step = slot_offset(slot), next = b + step;
      if (grid.find(next) != outside_band) continue;
      const std::pair<size_t, size_t> pair{grid.gap(b), grid.gap(next)};
      if (pair.first >= pair.second) continue;
      expected.insert(pair);
      faces[pair] += dot(step, step) == 1;
    }
  });
  gaps.for_each_contact([&](size_t a, size_t b) {
    EXPECT_LT(a, b);
    EXPECT_TRUE(found.insert({a, b}).second) << "once";
    EXPECT_EQ(shared_faces(gaps[a], gaps[b]), (faces[{a, b}]));
  });
  EXPECT_EQ(found, expected);
}

TEST_P(RandomGaps, EndWhereTheBoxDoes) {
  std::vector<double> faces(gaps.size());
  BrickRange::whole(box).for_each([&](Vec3i b) {
    if (grid.find(b) >= 0) return;
    for (int axis = 0; axis < 3; ++axis) faces[grid.gap(b)] += (b[axis] == 0) + (b[axis] == box[axis] - 1);
  });
  for (size_t gap = 0; gap < gaps.size(); ++gap) EXPECT_EQ(faces_at_end(gaps[gap], BrickRange::whole(box)), faces[gap]);
}

TEST_P(RandomGaps, TakeTheirSideFromABrickThatIsMeant) {
  const BrickRange meant{{1, 2, 3}, {6, 6, 5}};
  const GapSides sides(grid, meant, [&](Vec3i b) {
    EXPECT_TRUE(meant.contains(b) && grid.find(b) == outside_band);
    return true;
  });
  for (size_t gap = 0; gap < gaps.size(); ++gap) EXPECT_EQ(sides[gap], !gaps[gap].common(meant).empty());
  BrickRange{{-1, -1, -1}, box}.for_each([&](Vec3i b) {
    const int32_t slot = grid.find(b);
    EXPECT_EQ(sides.test(grid, b), slot == outside_band && sides[grid.gap(b)]);
  });
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomGaps, testing::Range(uint64_t{1}, uint64_t{25}));

/// What a grid costs does not depend on how far apart its bricks are.
TEST(GapSides, CanBeByBrick) {
  const Vec3i box{4, 4, 4};
  BrickMask active(box), inside(box);
  active.set({1, 1, 1});
  inside.set({1, 1, 1});  // has values: does not count
  inside.set({2, 1, 1});
  inside.set({3, 3, 3});
  const BrickGrid grid(active, Context(1));
  const GapSides sides(inside);
  EXPECT_TRUE(sides.are_by_brick());
  EXPECT_TRUE(sides.test(grid, {2, 1, 1}));
  EXPECT_FALSE(sides.test(grid, {1, 1, 1}));
  EXPECT_FALSE(sides.test(grid, {1, 2, 1})) << "the same gap, another side";
  EXPECT_FALSE(sides.test(grid, {4, 1, 1})) << "beyond the box";
  EXPECT_EQ(sides.count(grid), 2u * brick_volume);
}

TEST(BrickGrid, OfFarBricksCostsWhatThatOfNearOnesDoes) {
  const int far = 1 << 25;
  const auto grid_at = [&](Vec3i place, Vec3i box) {
    BrickMask mask(box);
    BrickRange{{1, 1, 1}, {4, 4, 4}}.for_each([&](Vec3i b) {
      mask.set(b);
      mask.set(place + b);
    });
    return BrickGrid(mask, one_thread);
  };
  const BrickGrid near = grid_at({8, 8, 8}, {16, 16, 16}),
                  apart = grid_at({far, far, far}, {far + 8, far + 8, far + 8});
  ASSERT_EQ(apart.size(), near.size());
  EXPECT_EQ(apart.gaps(), near.gaps());
  EXPECT_LE(static_cast<double>(apart.bytes()), 1.1 * static_cast<double>(near.bytes()));
  for (size_t b = 0; b < near.size(); ++b) {
    EXPECT_EQ(apart.neighbors(b), near.neighbors(b));
    EXPECT_EQ(apart.find(apart.coord(b)), static_cast<int32_t>(b));
  }
  const Vec3i between{far / 2, far / 2, far / 2};
  EXPECT_EQ(apart.find(between), outside_band);
  EXPECT_TRUE(Gaps(apart)[apart.gap(between)].contains(between));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
