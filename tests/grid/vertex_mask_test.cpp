#include "soapfilm/grid/vertex_mask.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

VertexMask random_mask(Vec3i bricks, double share, uint64_t seed) {
  Random random(seed);
  VertexMask mask(bricks);
  const Vec3i n = mask.vertices();
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x)
        if (random.uniform() < share) mask.set({x, y, z});
  return mask;
}

TEST(VertexMask, VisitsWhatWasSetInOrder) {
  const std::vector<Vec3i> set = {{0, 0, 0}, {7, 0, 0}, {8, 0, 0}, {3, 9, 0}, {2, 0, 5}, {23, 15, 7}};
  VertexMask mask({3, 2, 1});
  for (auto v = set.rbegin(); v != set.rend(); ++v) mask.set(*v);
  std::vector<Vec3i> visited;
  mask.for_each([&](Vec3i v) { visited.push_back(v); });
  EXPECT_EQ(visited, set);
  EXPECT_TRUE(mask.test({23, 15, 7}));
  for (const Vec3i beyond : {Vec3i{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {24, 0, 0}, {0, 16, 0}, {0, 0, 8}})
    EXPECT_FALSE(mask.test(beyond));
}

TEST(VertexMask, DilatesByACube) {
  for (const int radius : {1, 2, 5, 11}) {
    const VertexMask before = random_mask({3, 2, 2}, 0.001, static_cast<uint64_t>(radius));
    VertexMask expected(before.bricks());
    const Vec3i n = before.vertices();
    before.for_each([&](Vec3i v) {
      for (int z = std::max(0, v.z - radius); z <= std::min(n.z - 1, v.z + radius); ++z)
        for (int y = std::max(0, v.y - radius); y <= std::min(n.y - 1, v.y + radius); ++y)
          for (int x = std::max(0, v.x - radius); x <= std::min(n.x - 1, v.x + radius); ++x) expected.set({x, y, z});
    });
    for (const int threads : {1, 3}) {
      VertexMask mask = before;
      mask.dilate(radius, Context(threads));
      EXPECT_TRUE(mask == expected) << "radius " << radius;
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
