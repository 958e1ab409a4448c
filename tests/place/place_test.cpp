// The voxel by default: as fine as the samples are close, but not far below their noise.
#include "soapfilm/place/place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/reconstruct.h"
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
    // Curvature counts as noise: of ten clouds 1.12 to 1.18 and 1.48 to 1.56 of it are measured.
    const double curvature = spacings > 2 ? 0.6 : 0.25;
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

/// A few hundred samples of a sphere, and many more within so small a distance of one place on it.
PointCloud with_cluster(double radius, bool flat) {
  PointCloud cloud = sample_surface(*make_sphere(), 224, 1);
  const Vec3d at = cloud.positions[0];
  Random random(2);
  for (int i = 0; i < 2855; ++i) {
    const Vec3d p = at + Vec3d{random.normal(), random.normal(), random.normal()} * (radius / 2);
    cloud.positions.push_back(flat ? p * (norm(at) / norm(p)) : p);
    cloud.normals.push_back(static_cast<Vec3f>(normalized(p)));
  }
  cloud.scans.back().end = cloud.size();
  return cloud;
}

TEST(Place, NearlyCoincidingSamplesDoNotSetTheVoxel) {
  const double sphere_volume = std::acos(-1.0) / 6;
  const PointCloud alone = sample_surface(*make_sphere(), 224, 1);
  const double expected = reconstruct(alone, {}, Context(1)).report.grid.voxel;
  for (const double radius : {0.0001, 0.001, 0.003, 0.01})
    for (const bool flat : {false, true}) {
      PointCloud cloud = with_cluster(radius, flat);
      for (const bool bare : {false, true}) {
        if (bare) cloud.normals.clear();
        const Reconstruction found = reconstruct(cloud, {}, Context(2));
        EXPECT_NEAR(found.report.grid.voxel, expected, 0.2 * expected) << radius;
        EXPECT_NEAR(found.mesh.volume(), sphere_volume, 0.1 * sphere_volume) << radius;
        std::string warnings;
        for (const std::string& w : found.report.warnings) warnings += w;
        EXPECT_NE(warnings.find("nearly coincide"), std::string::npos) << warnings;
      }
    }
}

/// Each place measured many times, almost the same: as if measured once. Many small objects far apart are surfaces.
TEST(Place, NearCopiesAreOneSampleObjectsAreNot) {
  const auto spread = [](double radius, int copies) {
    const PointCloud once = sample_surface(*make_sphere(), 224, 1);
    PointCloud cloud;
    Random random(3);
    for (size_t i = 0; i < once.size(); ++i)
      for (int k = 0; k < copies; ++k) {
        const Vec3d from = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
        cloud.positions.push_back(once.positions[i] + from * radius);
        cloud.normals.push_back(radius < 1e-4 ? once.normals[i] : static_cast<Vec3f>(from));
      }
    cloud.scans.push_back({"spread", 0, cloud.size(), {}, {}, {}});
    const Context context(1);
    const Box3d box = cloud.box();
    const LocalSurface surface = measure_local_surface(cloud.positions, cloud.normals, box, context);
    return place_grid(cloud, box, {surface, cloud.normals}, {}, true, context);
  };
  const Grid copies = spread(1e-6, 14);
  EXPECT_NEAR(copies.lattice.voxel, 0.12, 0.03);
  EXPECT_FALSE(copies.weights.empty());
  EXPECT_TRUE(spread(1e-3, 14).weights.empty());
}

/// Neither an uneven density nor a few far outliers are taken for clusters.
TEST(Place, UnevenSamplesAreNoClusters) {
  Scanned scanned("torus", 0);
  EXPECT_TRUE(scanned.grid().weights.empty());
  Random random(3);
  PointCloud& cloud = scanned.cloud;
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = cloud.positions[i].x < 0 || random.uniform() < 0.01;
  cloud.filter(keep);
  EXPECT_TRUE(scanned.grid().weights.empty());
  for (int i = 0; i < 5; ++i) cloud.positions[static_cast<size_t>(i)] = Vec3d{40.0 + i, 3.0 * i, 20};
  EXPECT_TRUE(scanned.grid().weights.empty());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
