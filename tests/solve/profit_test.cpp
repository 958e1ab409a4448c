#include "soapfilm/solve/profit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "soapfilm/core/names.h"

namespace soapfilm {
namespace TEST_FILE {

/// The iterations after which a gap is found to have stalled, evaluated every `every` iterations; 0: never.
int stalls_after(const std::function<double(int)>& gap, int every, bool whole = true) {
  Stall stall;
  for (int iterations = every; iterations <= 20000; iterations += every)
    if (stall.found(iterations, gap(iterations), whole)) return iterations;
  return 0;
}

TEST(Stall, IsNotFoundWhereTheGapFalls) {
  for (const int every : {1, 7, 32, 100})
    for (const double power : {0.5, 1.0, 2.0})
      EXPECT_EQ(stalls_after([&](int k) { return std::pow(k, -power); }, every), 0) << every << ' ' << power;
  // Nor if it oscillates while it falls.
  EXPECT_EQ(stalls_after([](int k) { return (1 + 0.5 * (k / 32 % 2)) / k; }, 32), 0);
}

TEST(Stall, IsFoundSoonWhereTheGapStays) {
  for (const int floor_at : {20, 100, 500, 2000}) {
    const int after = stalls_after([&](int k) { return 1.0 / std::min(k, floor_at); }, 32);
    EXPECT_GE(after, floor_at);
    EXPECT_LE(after, std::max(128, 2 * floor_at)) << "at most as long again as it took to get there";
  }
  EXPECT_GT(stalls_after([](int k) { return k < 200 ? 1.0 / k : k * 2.5e-5; }, 32), 0) << "it rises";
}

/// Estimates are compared with estimates: a constant error does not matter.
TEST(Stall, KeepsLooksOfAKindApart) {
  Stall stall;
  for (int k = 32; k <= 2000; k += 32) {
    const bool whole = k / 32 % 4 == 0;
    EXPECT_FALSE(stall.found(k, (whole ? 1.3 : 1.0) / std::sqrt(k), whole)) << k;
  }
}

TEST(Stop, HasNames) {
  EXPECT_EQ(name_of(Stop::converged), "converged");
  EXPECT_EQ(name_of(Stop::limit), "limit");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
