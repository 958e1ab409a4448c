#include "soapfilm/field/samples.h"

#include <gtest/gtest.h>

#include "support/problem.h"

namespace soapfilm {
namespace {

using namespace test;

TEST(Samples, EachIsInItsBrickInTheOrderOfTheCloud) {
  const PointCloud cloud = sampled("part", 48, 1);
  const Problem problem = make_problem(cloud, 48);
  const GridSamples& samples = problem.samples;
  ASSERT_EQ(samples.size(), cloud.size());
  std::vector<bool> seen(cloud.size(), false);
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    EXPECT_LT(samples.begin[b], samples.begin[b + 1]) << "a brick without samples";
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const uint32_t i = samples.source[s];
      EXPECT_FALSE(seen[i]);
      seen[i] = true;
      EXPECT_TRUE(s == samples.begin[b] || samples.source[s - 1] < i);
      const Vec3d position = problem.lattice.to_lattice(cloud.positions[i]);
      const Vec3d stored = Vec3d(samples.bricks.first_vertex(b)) + Vec3d(samples.local[s]);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(stored[axis], position[axis], 1e-6);
        EXPECT_TRUE(samples.local[s][axis] >= 0 && samples.local[s][axis] <= brick_side);
      }
    }
  }
}

TEST(Samples, WithoutADirectionOrWeightSayNothing) {
  PointCloud cloud = sampled("sphere", 40, 1);
  const size_t all = cloud.size();
  cloud.normals[3] = {};
  cloud.weights.assign(all, 2.0f);
  cloud.weights[5] = 0;
  const Problem problem = make_problem(cloud, 40);
  EXPECT_EQ(problem.samples.size(), all - 2);
  for (const uint32_t i : problem.samples.source) EXPECT_TRUE(i != 3 && i != 5);
  EXPECT_EQ(problem.samples.direction[0], cloud.normals[problem.samples.source[0]] * 2.0f);
}

/// Offsets of 5e6 with detail of 1e-3: the grid sees the same samples.
TEST(Samples, GeoreferencedCoordinatesLoseNothing) {
  PointCloud near = sampled("part", 48, 1);
  // Multiples of 2^-20 are exact at either place.
  for (Vec3d& p : near.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] * 0x1p20) * 0x1p-20;
  const Vec3d offset{5e6, -4e6, 3e6};
  const PointCloud far = transformed(
      near, [&](Vec3d p) { return p + offset; }, [](Vec3f n) { return n; });
  const Problem a = make_problem(near, place_lattice(near.box(), 0x1p-5, 6));
  const Problem b = make_problem(far, place_lattice(far.box(), 0x1p-5, 6));
  EXPECT_EQ(a.lattice.size, b.lattice.size);
  EXPECT_EQ(a.samples.local, b.samples.local);
  EXPECT_EQ(a.samples.source, b.samples.source);
}

}  // namespace
}  // namespace soapfilm
