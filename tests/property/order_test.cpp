// The order in which samples come says nothing: no byte of the mesh depends on it.
#include <gtest/gtest.h>

#include <string>

#include "soapfilm/reconstruct.h"
#include "support/problem.h"
#include "support/shuffled.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

PointCloud noisy_cloud(const std::string& shape) {
  constexpr int resolution = 48;
  PointCloud cloud = sampled(shape, resolution, 2);
  add_noise(cloud, 0.3 / resolution, 5);
  return cloud;
}

void expect_same_bytes_in_any_order(const PointCloud& cloud, const ReconstructParams& params = {}) {
  const Reconstruction original = reconstruct(cloud, params, Context(1));
  ASSERT_GT(original.mesh.triangles.size(), 1000u);
  for (const uint64_t seed : {1, 2}) {
    const PointCloud other = shuffled(cloud, seed);
    ASSERT_NE(other.positions, cloud.positions);
    const Reconstruction again = reconstruct(other, params, Context(2));
    EXPECT_EQ(again.mesh.vertices, original.mesh.vertices);
    EXPECT_EQ(again.mesh.triangles, original.mesh.triangles);
    EXPECT_EQ(again.report.certificate.binary.gap, original.report.certificate.binary.gap);
  }
}

TEST(OrderOfSamples, WithNormalsChangesNoByte) {
  for (const char* shape : {"knot", "part"}) expect_same_bytes_in_any_order(noisy_cloud(shape));
}

/// Neighbors, planes, the spanning tree of their sides: ties are broken by place. So are those of coordinates on a
/// raster, as files of surveys have them: many neighbors are equally near, some samples lie at one place.
TEST(OrderOfSamples, WithoutDirectionsChangesNoByte) {
  for (const double raster : {0.0, 0x1p-7}) {
    PointCloud cloud = noisy_cloud("torus");
    cloud.normals.clear();
    if (raster > 0)
      for (Vec3d& p : cloud.positions)
        for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] / raster) * raster;
    expect_same_bytes_in_any_order(cloud);
  }
}

TEST(OrderOfSamples, WithScannersAndWeightsChangesNoByte) {
  PointCloud cloud = noisy_cloud("sphere");
  Random random(4);
  for (size_t i = 0; i < cloud.size(); ++i) {
    cloud.sensors.push_back(cloud.positions[i] + static_cast<Vec3d>(cloud.normals[i]) * 2.0);
    cloud.weights.push_back(static_cast<float>(0.5 + random.uniform()));
  }
  cloud.normals.clear();
  expect_same_bytes_in_any_order(cloud);
}

TEST(OrderOfSamples, ChangesNeitherFoldsNorTheLambdaThatTheyChoose) {
  ReconstructParams params;
  params.energy.cross_validate = true;
  expect_same_bytes_in_any_order(noisy_cloud("part"), params);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
