// Laws of sums by place: they do not see what else there is, where it is counted from, or who computes it.
#include "soapfilm/grid/ordered_sum.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace soapfilm {
namespace TEST_FILE {

/// A term that shows its place, and of which the order of a sum shows.
double term_at(Vec3i brick) {
  const auto seed = static_cast<uint64_t>(brick.x % 32 + 100 * (brick.y % 32) + 10000 * (brick.z % 32));
  return Random(seed).uniform(-1, 1) * std::pow(10, static_cast<int>(seed % 7));
}

/// One brick in five of the box [from, to).
BrickMask some_bricks(Vec3i box, Vec3i from, Vec3i to, Vec3i shift = {}) {
  BrickMask mask(box);
  for (int z = from.z; z < to.z; ++z)
    for (int y = from.y; y < to.y; ++y)
      for (int x = from.x; x < to.x; ++x)
        if ((x * 7 + y * 3 + z * 11) % 5 == 0) mask.set(Vec3i{x, y, z} + shift);
  return mask;
}

double sum_of(const BrickMask& mask, const Context& context = Context(1)) {
  const BrickGrid grid(mask, context);
  return ordered_sum<double>(grid, context, [&](size_t b) { return term_at(grid.coord(b)); });
}

const Vec3i box{80, 70, 100};

TEST(OrderedSum, IsNearTheExactSum) {
  const BrickMask mask = some_bricks(box, {3, 5, 2}, {75, 60, 90});
  long double exact = 0, size = 0;
  mask.for_each([&](Vec3i b) {
    exact += static_cast<long double>(term_at(b));
    size += std::abs(static_cast<long double>(term_at(b)));
  });
  EXPECT_NEAR(sum_of(mask), static_cast<double>(exact), 1e-13 * static_cast<double>(size));
}

TEST(OrderedSum, IsTheSameForAllThreadsAndForTermsThatAreThereAlready) {
  const BrickMask mask = some_bricks(box, {3, 5, 2}, {75, 60, 90});
  const double expected = sum_of(mask);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(sum_of(mask, Context(threads)), expected);
  const BrickGrid grid(mask, Context(1));
  std::vector<double> terms;
  for (size_t b = 0; b < grid.size(); ++b) terms.push_back(term_at(grid.coord(b)));
  EXPECT_EQ(ordered_sum(grid, terms), expected);
}

TEST(OrderedSum, IsTheSameInALargerBoxAndAnyTilesAway) {
  const double expected = sum_of(some_bricks(box, {3, 5, 2}, {25, 30, 31}));
  EXPECT_EQ(sum_of(some_bricks({200, 300, 90}, {3, 5, 2}, {25, 30, 31})), expected);
  for (const Vec3i tiles : {Vec3i{32, 0, 0}, Vec3i{0, 64, 0}, Vec3i{32, 96, 64}})
    EXPECT_EQ(sum_of(some_bricks({200, 300, 100}, {3, 5, 2}, {25, 30, 31}, tiles)), expected);
}

TEST(OrderedSum, OfTilesIsTheSumOfTheirs) {
  const BrickMask low = some_bricks(box, {0, 0, 0}, {32, 32, 32}), high = some_bricks(box, {32, 0, 0}, {64, 32, 32});
  BrickMask both = low;
  both |= high;
  EXPECT_EQ(sum_of(both), sum_of(low) + sum_of(high));
  TileSums<double> below;  // coordinates below 0 have tiles of their own
  below.add({-1, 0, 0}, 1e20);
  below.add({0, 0, 0}, 1);
  below.add({1, 0, 0}, 2);
  EXPECT_EQ(below.total(), 1e20 + 3);
}

TEST(SampledBricks, AreChosenByPlaceAndEvenly) {
  for (const size_t stride : {2, 7, 50}) {
    size_t count = 0;
    std::array<size_t, 4> by_corner{};
    for (int z = 0; z < 64; ++z)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
          if (is_sampled({x, y, z}, stride)) {
            ++count;
            ++by_corner[static_cast<size_t>(x % 2 + 2 * (y % 2))];
          }
    const double expected = 64. * 64 * 64 / static_cast<double>(stride);
    EXPECT_NEAR(static_cast<double>(count), expected, 4 * std::sqrt(expected));
    for (const size_t of_corner : by_corner)
      EXPECT_NEAR(static_cast<double>(of_corner), expected / 4, 4 * std::sqrt(expected / 4));
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
