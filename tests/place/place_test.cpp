// The voxel by default: as fine as the samples are close, but not far below their noise.
#include "soapfilm/place/place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr size_t samples = 30000;
constexpr double least_over_noise = 1.75;

/// A surface, sampled evenly with noise of so many spacings along its normals.
struct Scanned {
  PointCloud cloud;
  double spacing, noise;

  Scanned(const char* shape, double spacings) {
    const auto surface = make_shape(shape);
    spacing = std::sqrt(area_of(*surface) / static_cast<double>(samples));
    noise = spacings * spacing;
    cloud = sample_surface(*surface, samples, 1);
    add_noise(cloud, noise, 7);
  }

  Grid grid(const PlaceParams& params = {}) const {
    const Context context(2);
    const Box3d box = cloud.box();
    const LocalSurface surface = measure_local_surface(cloud.positions, cloud.normals, box, context);
    return place_grid(cloud, box, {surface, cloud.normals}, params, true, context);
  }
};

TEST(Place, CleanSamplesSetTheVoxelByTheirSpacing) {
  for (const char* shape : {"sphere", "torus", "knot"}) {
    const Scanned scanned(shape, 0);
    const Grid grid = scanned.grid();
    EXPECT_FALSE(grid.voxel_by_noise) << shape;
    EXPECT_EQ(grid.lattice.voxel, grid.default_voxel);
    EXPECT_NEAR(grid.lattice.voxel, scanned.spacing, 0.35 * scanned.spacing) << shape;
    EXPECT_LT(grid.noise, 0.2 * scanned.spacing) << shape;
  }
}

TEST(Place, NoiseOfSpacingsSetsTheVoxel) {
  for (const double spacings : {1.5, 3.0}) {
    const Scanned scanned("sphere", spacings);
    const Grid grid = scanned.grid();
    const double expected = least_over_noise * scanned.noise;
    EXPECT_TRUE(grid.voxel_by_noise) << spacings;
    EXPECT_GE(grid.lattice.voxel, least_over_noise * grid.noise * (1 - 1e-12)) << spacings;
    const double curvature = spacings > 2 ? 0.5 : 0.25;  // of the larger neighborhoods counts as noise, too
    EXPECT_NEAR(grid.lattice.voxel, expected, curvature * expected) << spacings;
  }
}

TEST(Place, NoiseBelowTheSpacingChangesNothing) {
  const double clean = Scanned("sphere", 0).grid().lattice.voxel;
  const Grid grid = Scanned("sphere", 0.3).grid();
  EXPECT_FALSE(grid.voxel_by_noise);
  EXPECT_NEAR(grid.lattice.voxel, clean, 0.2 * clean);
}

/// What is asked for counts; the default is known all the same, as the scale of the scene.
TEST(Place, AGivenVoxelIsTaken) {
  const Scanned scanned("sphere", 3);
  const Grid by_default = scanned.grid();
  for (const double factor : {0.5, 2.0}) {
    PlaceParams params;
    params.voxel = factor * by_default.lattice.voxel;
    const Grid grid = scanned.grid(params);
    EXPECT_EQ(grid.lattice.voxel, *params.voxel);
    EXPECT_EQ(grid.default_voxel, by_default.default_voxel);
    EXPECT_EQ(grid.noise, by_default.noise);
    EXPECT_FALSE(grid.voxel_by_noise);
  }
}

/// More frames of the same noise do not make the grid finer.
TEST(Place, MoreSamplesOfTheSameNoiseKeepTheVoxel) {
  Scanned scanned("sphere", 2);
  const double once = scanned.grid().lattice.voxel;
  PointCloud more = sample_surface(*make_shape("sphere"), samples, 2);
  add_noise(more, scanned.noise, 8);
  scanned.cloud.append(std::move(more));
  EXPECT_NEAR(scanned.grid().lattice.voxel, once, 0.25 * once);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
