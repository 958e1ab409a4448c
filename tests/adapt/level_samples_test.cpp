#include "soapfilm/adapt/level_samples.h"

#include <gtest/gtest.h>

#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

TEST(LevelSamples, KeepTheirPlacesAndWhatTheyCarry) {
  const PointCloud cloud = sampled("knot", 60, 1);
  const Problem problem = make_problem(cloud, 60);
  LevelSamples fine{problem.samples, problem.samples.direction, {}};
  for (size_t s = 0; s < fine.samples.size(); ++s) fine.spacing.push_back(static_cast<float>(s));
  const LevelSamples coarse = on_next_level(fine, problem.lattice.box(1).bricks, one_thread);
  ASSERT_EQ(coarse.samples.size(), fine.samples.size());
  const std::vector<Vec3d> before = lattice_positions(fine.samples), after = lattice_positions(coarse.samples);
  const Lattice of_coarse = problem.lattice.of_level(1);
  for (size_t k = 0; k < after.size(); ++k) {
    const auto s = static_cast<size_t>(coarse.spacing[k]);
    EXPECT_LT(norm(of_coarse.to_world(after[k]) - problem.lattice.to_world(before[s])), 1e-5 * problem.lattice.voxel);
    EXPECT_EQ(coarse.samples.direction[k], fine.samples.direction[s]);
    EXPECT_EQ(coarse.views[k], fine.views[s]);
    const Vec3f q = coarse.samples.local[k];
    for (int axis = 0; axis < 3; ++axis) ASSERT_TRUE(q[axis] >= 0 && q[axis] < brick_side);
  }
  // The order of the finer level within a brick.
  for (size_t b = 0; b < coarse.samples.bricks.size(); ++b)
    for (uint32_t k = coarse.samples.begin[b] + 1; k < coarse.samples.begin[b + 1]; ++k)
      ASSERT_LT(coarse.spacing[k - 1], coarse.spacing[k]);
}

/// To the finer level and back: the same places, only of the bricks asked for.
TEST(LevelSamples, OnTheFinerLevelTheyAreTheSame) {
  const PointCloud cloud = sampled("knot", 60, 1);
  const Problem problem = make_problem(cloud, 60);
  LevelSamples samples{problem.samples, problem.samples.direction, {}};
  for (size_t s = 0; s < samples.samples.size(); ++s) samples.spacing.push_back(static_cast<float>(s));
  const GridSamples& placed = samples.samples;
  BrickMask some(placed.bricks.bricks());
  size_t expected = 0;
  for (size_t b = 0; b < placed.bricks.size(); b += 2) {
    some.set(placed.bricks.coord(b));
    expected += placed.begin[b + 1] - placed.begin[b];
  }
  const Lattice refined = problem.lattice.refined(1);
  const LevelSamples fine = on_finer_level(samples, some, refined.box(0).bricks, one_thread);
  ASSERT_EQ(fine.samples.size(), expected);
  const std::vector<Vec3d> before = lattice_positions(placed), after = lattice_positions(fine.samples);
  for (size_t k = 0; k < after.size(); ++k) {
    const auto s = static_cast<size_t>(fine.spacing[k]);
    EXPECT_LT(norm(refined.to_world(after[k]) - problem.lattice.to_world(before[s])), 1e-5 * problem.lattice.voxel);
    EXPECT_EQ(fine.views[k], samples.views[s]);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
