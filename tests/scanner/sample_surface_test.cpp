#include "tools/scanner/sample_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(SampleSurface, NoiseIsGaussianAlongTheNormal) {
  const auto shape = make_sphere();
  const PointCloud cloud = sample_surface(*shape, {.count = 40000, .noise = 0.01}, Context(2));
  double sum = 0, squares = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const double error = shape->signed_distance(cloud.positions[i]);
    sum += error;
    squares += error * error;
    ASSERT_LE(norm(static_cast<Vec3d>(cloud.normals[i]) - normalized(cloud.positions[i])), 1e-6);
  }
  EXPECT_NEAR(sum / 40000, 0.0, 4 * 0.01 / 200);
  EXPECT_NEAR(std::sqrt(squares / 40000), 0.01, 0.0002);
}

TEST(SampleSurface, OutliersFillTheirBoxWithRandomDirections) {
  const auto shape = make_plate();
  const PointCloud cloud = sample_surface(*shape, {.count = 20000, .outliers = 0.25}, Context(2));
  const Box3d box = outlier_box(shape->box());
  size_t outliers = 0;
  Vec3d mean, mean_normal;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Vec3d p = cloud.positions[i];
    if (shape->distance(p) < 1e-9) continue;
    ++outliers;
    for (int axis = 0; axis < 3; ++axis) ASSERT_TRUE(p[axis] >= box.lo[axis] && p[axis] <= box.hi[axis]);
    ASSERT_NEAR(norm(cloud.normals[i]), 1.0, 1e-5);
    mean += p;
    mean_normal += static_cast<Vec3d>(cloud.normals[i]);
  }
  EXPECT_NEAR(static_cast<double>(outliers), 5000.0, 250.0);
  EXPECT_LE(norm(mean) / static_cast<double>(outliers), 0.03);
  EXPECT_LE(norm(mean_normal) / static_cast<double>(outliers), 0.04);
}

TEST(SampleSurface, SwitchingOutliersOnLeavesTheOtherSamplesAsTheyWere) {
  const auto shape = make_torus();
  const PointCloud clean = sample_surface(*shape, {.count = 5000, .noise = 1e-3}, Context(1));
  const PointCloud some = sample_surface(*shape, {.count = 5000, .noise = 1e-3, .outliers = 0.1}, Context(1));
  size_t same = 0;
  for (size_t i = 0; i < 5000; ++i) same += clean.positions[i] == some.positions[i] ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(same), 4500.0, 90.0);
}

TEST(SampleSurface, EachSampleHasTheSensorThatSeesItMostSquarely) {
  const auto shape = make_sheets();
  ScannerParams views;
  views.views = 40;
  SamplingParams params;
  params.count = 3000;
  params.sensors = scanner_positions(shape->box(), views);
  const PointCloud cloud = sample_surface(*shape, params, Context(2));
  EXPECT_TRUE(cloud.normals.empty());
  ASSERT_EQ(cloud.sensors.size(), cloud.size());
  size_t hidden = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const SurfacePoint at = shape->closest(cloud.positions[i]);
    const auto cosine = [&](Vec3d sensor) { return dot(normalized(sensor - at.position), at.normal); };
    const auto sees = [&](Vec3d sensor) {
      const Vec3d above = at.position + at.normal * 1e-6;
      return cosine(sensor) > 0 && !shape->intersect(above, normalized(sensor - above));
    };
    const Vec3d given = cloud.sensors[i];
    if (!sees(given)) ++hidden;
    for (const Vec3d& sensor : params.sensors) {
      if (sees(sensor) || !sees(given)) {
        ASSERT_LE(cosine(sensor), cosine(given) + 1e-5);
      }
    }
  }
  EXPECT_LT(hidden, cloud.size() / 100);  // few places in the gap are seen by none of 40
}

TEST(SampleSurface, IsTheSameForAnyNumberOfThreads) {
  const auto shape = make_part();
  ScannerParams views;
  const SamplingParams params{
      .count = 3000, .noise = 1e-3, .outliers = 0.1, .sensors = scanner_positions(shape->box(), views), .seed = 5};
  const PointCloud one = sample_surface(*shape, params, Context(1));
  for (const int threads : {2, 5}) {
    const PointCloud many = sample_surface(*shape, params, Context(threads));
    EXPECT_EQ(many.positions, one.positions);
    EXPECT_EQ(many.sensors, one.sensors);
  }
}

TEST(SampleSurface, RefusalsNameTheValueAndItsConstraint) {
  const auto message = [](const SamplingParams& params) -> std::string {
    try {
      sample_surface(*make_sphere(), params, Context(1));
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({.count = 0}), "samples = 0, must be >= 1");
  EXPECT_EQ(message({.noise = -1.0}), "noise = -1, must be >= 0");
  EXPECT_EQ(message({.outliers = 2.0}), "outliers = 2, must be in [0, 1]");
  EXPECT_EQ(message({.sensors = {{0, NAN, 0}}}), "position: its coordinates must be finite");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
