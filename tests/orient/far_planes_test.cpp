#include "soapfilm/orient/far_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/orient/orient.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr double gap = 0.5;           // between rings
constexpr double on_ring = gap / 30;  // between samples of one ring
constexpr double within_degrees = 5;

/// Rings of a spinning scanner on the ground around it, from its 8th gap on, on the plane z = slope x.
std::vector<Vec3d> rings(double slope, double noise = 0) {
  Random random(6);
  std::vector<Vec3d> points;
  for (int ring = 8; ring < (test::sanitized ? 16 : 24); ++ring) {
    const double radius = ring * gap;
    const int around = static_cast<int>(2 * M_PI * radius / on_ring);
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * M_PI * (k + 0.3 * random.uniform()) / around;
      const double x = radius * std::cos(angle), y = radius * std::sin(angle);
      points.push_back({x, y, slope * x + noise * random.normal()});
    }
  }
  return points;
}

std::vector<uint32_t> all_of(const std::vector<Vec3d>& points) {
  std::vector<uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

std::vector<Vec3f> normals_of(const std::vector<Vec3d>& points, int threads = 2) {
  return far_planes(points, all_of(points), Context(threads));
}

/// Share of the normals that are near to a unit vector, whatever their sign.
double share_near(const std::vector<Vec3f>& normals, Vec3d truth) {
  const double least = std::cos(within_degrees / 57.29577951308232);
  size_t near = 0;
  for (const Vec3f& n : normals) near += std::abs(dot(static_cast<Vec3d>(n), truth)) > least;
  return static_cast<double>(near) / static_cast<double>(normals.size());
}

TEST(FarPlanes, AcrossTheGapsBetweenRingsThePlaneIsFound) {
  for (const double slope : {0.0, 0.3, -1.0}) {
    const std::vector<Vec3f> normals = normals_of(rings(slope, 0.2 * on_ring));
    EXPECT_GE(share_near(normals, normalized(Vec3d{-slope, 0, 1})), 0.95) << "slope " << slope;
    for (const Vec3f& n : normals) EXPECT_NEAR(norm(n), n == Vec3f{} ? 0 : 1, 1e-6);
  }
}

/// The nearest neighbors alone do not know it: they lie on the ring, whose own noise decides.
TEST(FarPlanes, DirectionsEstimatedOnRingsAreThoseOfTheGround) {
  PointCloud cloud;
  cloud.positions = rings(0.3, 0.2 * on_ring);
  cloud.scans.push_back({"rings", 0, cloud.size(), {}, {}, {}});
  OrientReport report;
  const std::vector<Vec3f> directions = orient(cloud, {}, Context(2), report);
  EXPECT_GE(share_near(directions, normalized(Vec3d{-0.3, 0, 1})), 0.95);
  EXPECT_GT(static_cast<double>(report.far_planes), 0.9 * static_cast<double>(cloud.size()));
}

TEST(FarPlanes, ABallHasNone) {
  Random random(2);
  std::vector<Vec3d> points;
  while (points.size() < 6000) {
    const Vec3d p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(p) < 1) points.push_back(p);
  }
  const std::vector<Vec3f> normals = normals_of(points);
  EXPECT_LE(static_cast<double>(std::count_if(normals.begin(), normals.end(), [](Vec3f n) { return n != Vec3f{}; })),
            0.02 * static_cast<double>(normals.size()));
}

TEST(FarPlanes, ALineHasNone) {
  std::vector<Vec3d> line;
  for (int i = 0; i < 2000; ++i) line.push_back(Vec3d{1, 2, 3} * (0.01 * i));
  for (const Vec3f& n : normals_of(line)) EXPECT_EQ(n, Vec3f{});
  EXPECT_TRUE(normals_of({}).empty());
  EXPECT_EQ(normals_of({{1, 2, 3}, {1, 2, 3}}), std::vector<Vec3f>(2));
}

/// Each sample recorded twice says no more than once: up to rounding of the means.
TEST(FarPlanes, CopiesChangeNothing) {
  const std::vector<Vec3d> once = rings(0.3);
  std::vector<Vec3d> twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  const std::vector<Vec3f> expected = normals_of(once), found = normals_of(twice);
  for (size_t i = 0; i < twice.size(); ++i)
    ASSERT_NEAR(std::abs(dot(found[i], expected[i % once.size()])), dot(found[i], found[i]), 1e-6) << i;
}

TEST(FarPlanes, AreTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3d> points = rings(0.3, 0.2 * on_ring);
  const std::vector<Vec3f> one = normals_of(points, 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(normals_of(points, threads), one);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
