#include "soapfilm/border/surroundings.h"

#include <gtest/gtest.h>

#include "support/shuffled.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

const Context one_thread(1);

/// Samples of a sphere around the origin, radius 1; those below a height.
PointCloud sphere_below(double height) {
  PointCloud cloud = sample_surface(*make_sphere(), 20000, 1);
  for (Vec3d& p : cloud.positions) p = normalized(p);
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) keep[i] = cloud.positions[i].z < height;
  cloud.filter(keep);
  return cloud;
}

TEST(Surroundings, NothingIsKnownWithoutScanners) {
  const Surroundings around = measure_surroundings(sphere_below(2), {}, one_thread);
  EXPECT_EQ(around.scanners, 0u);
  EXPECT_FALSE(around.stand_among_samples());
}

TEST(Surroundings, AScannerInsideSeesSamplesAllAround) {
  for (const Vec3d place : {Vec3d{0, 0, 0}, Vec3d{0.5, -0.3, 0.4}}) {
    const Surroundings around = measure_surroundings(sphere_below(2), place, one_thread);
    EXPECT_EQ(around.scanners, 1u);
    EXPECT_TRUE(around.stand_among_samples());
    EXPECT_GT(around.covered, 0.98);
  }
}

TEST(Surroundings, UnderAnOpenSkySomeDirectionsAreFree) {
  const Surroundings around = measure_surroundings(sphere_below(0.4), Vec3d{0, 0, 0}, one_thread);
  EXPECT_TRUE(around.stand_among_samples());
  EXPECT_NEAR(around.covered, 0.7, 0.05);  // by Archimedes
}

TEST(Surroundings, ScannersBesideAnObjectAreNotAmongItsSamples) {
  PointCloud cloud = sphere_below(2);
  for (size_t i = 0; i < cloud.size(); ++i) cloud.sensors.push_back(cloud.positions[i] * 3.0);
  const Surroundings around = measure_surroundings(cloud, {}, one_thread);
  EXPECT_EQ(around.scanners, 16u);
  EXPECT_EQ(around.among, 0u);
  EXPECT_FALSE(around.stand_among_samples());
}

/// A scanner of each sample's own counts before its scan's, that before the one said of all.
TEST(Surroundings, TheNearestWordOnTheScannerCounts) {
  PointCloud cloud = sphere_below(2);
  EXPECT_FALSE(measure_surroundings(cloud, Vec3d{4, 0, 0}, one_thread).stand_among_samples());
  cloud.scans[0].sensor = Vec3d{0, 0, 0};
  EXPECT_TRUE(measure_surroundings(cloud, Vec3d{4, 0, 0}, one_thread).stand_among_samples());
  cloud.sensors.assign(cloud.size(), Vec3d{0, 4, 0});
  EXPECT_FALSE(measure_surroundings(cloud, Vec3d{4, 0, 0}, one_thread).stand_among_samples());
}

TEST(Surroundings, DoNotDependOnTheOrderOfTheSamples) {
  PointCloud cloud = sample_surface(*make_shape("knot"), 120000, 1);
  for (size_t i = 0; i < cloud.size(); ++i) cloud.sensors.push_back(cloud.positions[i / 300 * 300] * 0.8);
  const Surroundings around = measure_surroundings(cloud, {}, one_thread);
  EXPECT_EQ(around.scanners, 16u);
  EXPECT_GT(around.among, 0u);
  for (uint64_t seed = 1; seed < 3; ++seed) {
    const Surroundings other = measure_surroundings(test::shuffled(cloud, seed), {}, one_thread);
    EXPECT_EQ(other.scanners, around.scanners);
    EXPECT_EQ(other.among, around.among);
    EXPECT_EQ(other.covered, around.covered);
  }
}

TEST(Surroundings, OutliersDoNotCoverTheSky) {
  PointCloud cloud = sphere_below(0.4);
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.157 * i;
    cloud.positions.push_back(Vec3d{std::cos(angle) * 0.7, std::sin(angle) * 0.7, 2});
    cloud.normals.push_back({0, 0, 1});
  }
  cloud.scans[0].end = cloud.size();
  EXPECT_NEAR(measure_surroundings(cloud, Vec3d{0, 0, 0}, one_thread).covered, 0.7, 0.06);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
