#include "soapfilm/grid/brick_grid.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/window.h"

namespace soapfilm {
namespace TEST_FILE {

const Context one_thread(1);

BrickMask random_mask(Vec3i bricks, double share, uint64_t seed) {
  Random random(seed);
  BrickMask mask(bricks);
  BrickMask::whole(bricks).for_each([&](Vec3i b) { mask.set(b, random.uniform() < share); });
  return mask;
}

TEST(BrickMask, IsSetByManyThreadsAtOnce) {
  const Vec3i bricks{5, 7, 30};
  const BrickMask expected = random_mask(bricks, 0.5, 4);
  std::vector<Vec3i> wanted, set;
  expected.for_each([&](Vec3i b) { wanted.push_back(b); });
  for (const int threads : {1, 2, 3, 8}) {
    BrickMask mask(bricks);
    // Neighboring bricks share a word, and each is set twice.
    parallel_for(Context(threads), 2 * wanted.size(), 1, [&](size_t i) { mask.set_shared(wanted[i / 2]); });
    set.clear();
    mask.for_each([&](Vec3i b) { set.push_back(b); });
    EXPECT_EQ(set, wanted) << threads << " threads";
  }
}

TEST(BrickMask, CountsAndVisitsWhatWasSet) {
  BrickMask mask({5, 7, 3});
  EXPECT_EQ(mask.count(), 0u);
  mask.set({4, 6, 2});
  mask.set({0, 0, 0});
  mask.set({1, 0, 0});
  mask.set({1, 0, 0}, false);
  EXPECT_EQ(mask.count(), 2u);
  std::vector<Vec3i> seen;
  mask.for_each([&](Vec3i b) { seen.push_back(b); });
  EXPECT_EQ(seen, (std::vector<Vec3i>{{0, 0, 0}, {4, 6, 2}}));
  EXPECT_EQ(BrickMask::whole(mask.bricks()).count(), 5u * 7 * 3) << "no bits beyond the box";
  EXPECT_FALSE(mask.contains({5, 0, 0}));
  EXPECT_FALSE(mask.contains({0, -1, 0}));
}

TEST(BrickMask, CountsBitsAsTheProcessorDoes) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const uint64_t bits = i % 2 ? random.next() : random.next() & random.next() & random.next();
    ASSERT_EQ(count_bits(bits), std::popcount(bits));
  }
  EXPECT_EQ(count_bits(0), 0);
  EXPECT_EQ(count_bits(~uint64_t{0}), 64);
}

TEST(BrickGrid, KnowsTheParentsOfItsBricks) {
  const BrickMask fine = random_mask({32, 30, 28}, 0.1, 1);
  const BrickMask coarse = parents_of(BrickGrid(fine, one_thread), {16, 15, 14}, one_thread);
  for (const int threads : {2, 3, 8})
    EXPECT_TRUE(parents_of(BrickGrid(fine, one_thread), {16, 15, 14}, Context(threads)) == coarse);
  std::set<std::tuple<int, int, int>> parents;
  fine.for_each([&](Vec3i b) { parents.insert({b.x / 2, b.y / 2, b.z / 2}); });
  EXPECT_EQ(coarse.count(), parents.size());
  for (const auto& [x, y, z] : parents) EXPECT_TRUE(coarse.test({x, y, z}));
  fine.for_each([](Vec3i b) {
    int same = 0;
    for (int k = 0; k < 8; ++k)
      if (child_of(parent_of(b), k) == b) {
        ++same;
        EXPECT_EQ(octant_of(k), octant_in_parent(b));
      }
    EXPECT_EQ(same, 1);
  });
}

TEST(BrickGrid, OrdersBricksLexicographicallyAndFindsThem) {
  const BrickMask mask = random_mask({9, 7, 5}, 0.4, 2);
  const BrickGrid grid(mask, one_thread);
  ASSERT_EQ(grid.size(), mask.count());
  EXPECT_EQ(grid.vertices(), 512 * mask.count());
  for (size_t b = 1; b < grid.size(); ++b) {
    const Vec3i last = grid.coord(b - 1), next = grid.coord(b);
    EXPECT_LT(std::make_tuple(last.z, last.y, last.x), std::make_tuple(next.z, next.y, next.x));
  }
  BrickMask::whole(mask.bricks()).for_each([&](Vec3i b) {
    const int32_t found = grid.find(b);
    if (mask.test(b))
      EXPECT_EQ(grid.coord(static_cast<size_t>(found)), b);
    else
      EXPECT_EQ(found, outside_band);
  });
  for (int axis = 0; axis < 3; ++axis)
    for (const int beyond : {-1, mask.bricks()[axis]}) {
      Vec3i b{1, 1, 1};
      b[axis] = beyond;
      EXPECT_EQ(grid.find(b), outside_box);
    }
}

TEST(BrickGrid, KnowsAll27NeighborsForAnyNumberOfThreads) {
  const BrickMask mask = random_mask({20, 19, 18}, 0.5, 3);
  for (const int threads : {1, 3, 8}) {
    const BrickGrid grid(mask, Context(threads));
    for (size_t b = 0; b < grid.size(); ++b)
      for (int slot = 0; slot < 27; ++slot) {
        const Vec3i next = grid.coord(b) + slot_offset(slot);
        const int32_t found = grid.neighbors(b)[static_cast<size_t>(slot)];
        if (!mask.contains(next))
          ASSERT_EQ(found, outside_box);
        else if (!mask.test(next))
          ASSERT_EQ(found, outside_band);
        else
          ASSERT_EQ(grid.coord(static_cast<size_t>(found)), next);
      }
  }
}

TEST(BrickGrid, EmptyIsFine) {
  const BrickGrid grid(BrickMask({3, 3, 3}), one_thread);
  EXPECT_EQ(grid.size(), 0u);
  EXPECT_EQ(grid.find({1, 1, 1}), outside_band);
  EXPECT_EQ(Field<float>(grid).bricks(), 0u);
}

TEST(Field, StartsAtZeroAlignedToCacheLines) {
  Field<float, 3> field(size_t{5});
  for (size_t b = 0; b < 5; ++b)
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(reinterpret_cast<uintptr_t>(field.brick(b, c)) % 64, 0u);
      EXPECT_EQ(std::count(field.brick(b, c), field.brick(b, c) + brick_volume, 0.0f), brick_volume);
    }
  EXPECT_EQ(field.bytes(), 5u * 3 * brick_volume * sizeof(float));
}

/// Every vertex of a window against a look-up by lattice coordinates.
TEST(Window, ShowsTheNeighborsAndNamesTheMissing) {
  const BrickGrid grid(random_mask({4, 5, 4}, 0.5, 4), one_thread);
  const auto id = [](Vec3i v) { return static_cast<float>(v.x + 100 * v.y + 10000 * v.z); };
  Field<float> field(grid);
  for (size_t b = 0; b < grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i) field.brick(b)[i] = id(grid.first_vertex(b) + vertex_in_brick(i));
  constexpr int margin = 3;
  Window<float, margin> window;
  for (size_t b = 0; b < grid.size(); ++b) {
    fill_window(
        grid, b, [&](int, int32_t n) { return n >= 0 ? field.brick(static_cast<size_t>(n)) : nullptr; },
        [](int, int32_t n) { return n == outside_box ? -2.0f : -1.0f; }, window);
    for (int z = -margin; z < brick_side + margin; ++z)
      for (int y = -margin; y < brick_side + margin; ++y)
        for (int x = -margin; x < brick_side + margin; ++x) {
          const Vec3i v = grid.first_vertex(b) + Vec3i{x, y, z};
          const int32_t n = grid.find(brick_of(v));
          ASSERT_EQ(window.at(x, y, z), n >= 0 ? id(v) : static_cast<float>(n));
        }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
