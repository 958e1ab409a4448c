#include "soapfilm/orient/sites.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>
#include <vector>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

using Key = std::tuple<double, double, double>;
Key key_of(Vec3d p) { return {p.x, p.y, p.z}; }

/// Of integers, so that differences are exact; with copies.
std::vector<Vec3d> positions_of(size_t count, int most) {
  Random random(5);
  std::vector<Vec3d> positions;
  for (size_t i = 0; i < count; ++i)
    positions.push_back({std::floor(random.uniform() * most), std::floor(random.uniform() * most), 7});
  return positions;
}

TEST(Sites, AreTheDifferentPositionsEachOnce) {
  for (const int most : {1, 2, 10, 100000}) {
    const std::vector<Vec3d> positions = positions_of(2000, most);
    const Sites sites(positions, Context(2));
    std::set<Key> different, found;
    Vec3d low{1e9, 1e9, 1e9};
    for (const Vec3d& p : positions) {
      different.insert(key_of(p));
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    }
    for (size_t s = 0; s < sites.size(); ++s) found.insert(key_of(sites[s] + low));
    EXPECT_EQ(found, different);
    EXPECT_EQ(sites.size(), different.size());
    for (size_t i = 0; i < positions.size(); ++i)
      ASSERT_EQ(key_of(sites[sites.of_sample(i)] + low), key_of(positions[i]));
  }
}

TEST(Sites, DoNotDependOnTheOrderOfTheSamples) {
  std::vector<Vec3d> positions = positions_of(3000, 1000);
  const Sites first(positions, Context(1));
  std::reverse(positions.begin(), positions.end());
  EXPECT_EQ(first.points(), Sites(positions, Context(3)).points());
}

/// The sites as `before` orders them.
std::vector<Key> drawn(const Sites& sites, int shift) {
  std::vector<uint32_t> order(sites.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return sites.before(a, b); });
  std::vector<Key> keys;
  for (const uint32_t s : order) keys.push_back(key_of(permuted(sites[s], shift)));
  return keys;
}

TEST(Sites, TheirOtherOrderDoesNotDependOnTheAxes) {
  Random random(6);
  std::vector<Vec3d> positions{{0, 0, 0}};  // differences from it are exact
  for (int i = 0; i < 1000; ++i) positions.push_back({random.uniform(), random.uniform(), random.uniform()});
  const std::vector<Key> expected = drawn(Sites(positions, Context(1)), 0);
  for (const int shift : {1, 2}) {
    std::vector<Vec3d> turned;
    for (const Vec3d& p : positions) turned.push_back(permuted(p, shift));
    EXPECT_EQ(drawn(Sites(turned, Context(1)), 3 - shift), expected);
  }
}

TEST(Sites, OfADenseClusterFarFromOthersLieAlongACurve) {
  Random random(3);
  std::vector<Vec3d> positions{{1e12, 1e12, 1e12}};
  for (int i = 0; i < 4000; ++i) positions.push_back({random.uniform(), random.uniform(), random.uniform()});
  const Sites sites(positions, Context(2));
  double way = 0;
  for (size_t s = 1; s < 4000; ++s) way += norm(sites[s] - sites[s - 1]);
  EXPECT_LT(way / 4000, 0.12);  // the spacing is 0.06; in the order of one axis 0.5
}

}  // namespace TEST_FILE
}  // namespace soapfilm
