#include "soapfilm/finish/self_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/finish/nearest_sample.h"
#include "tools/mesh/distance.h"

namespace soapfilm {
namespace TEST_FILE {

/// A flat sheet of 80 x 80 voxels, of triangles of one voxel, and samples on a plane of the same size.
struct Scene {
  static constexpr int side = 80;
  Lattice lattice;
  Mesh mesh;
  PointCloud cloud;
  GridSamples samples;

  /// Samples lie `height(x)` voxels above the sheet; the sheet is drawn where `drawn(x)`.
  Scene(size_t count, const std::function<double(double)>& height, const std::function<bool(int)>& drawn) {
    lattice.size = {side + 30, side + 30, 50};
    lattice.voxel = 0.25;
    lattice.first_vertex = {1000, 0, -3};
    for (int y = 0; y <= side; ++y)
      for (int x = 0; x <= side; ++x) mesh.vertices.push_back(at(x, y, 0));
    const auto index = [](int x, int y) { return static_cast<uint32_t>(y * (side + 1) + x); };
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        if (!drawn(x)) continue;
        mesh.triangles.push_back({index(x, y), index(x + 1, y), index(x + 1, y + 1)});
        mesh.triangles.push_back({index(x, y), index(x + 1, y + 1), index(x, y + 1)});
      }
    Random random(5);
    for (size_t i = 0; i < count; ++i) {
      const double x = random.uniform(0, side), y = random.uniform(0, side);
      cloud.positions.push_back(at(x, y, height(x)));
    }
    cloud.normals.assign(count, {0, 0, 1});
    samples = sort_samples(cloud, cloud.normals, lattice, Context(1));
  }
  Vec3d at(double x, double y, double z) const { return lattice.to_world({15 + x, 15 + y, 20 + z}); }
  SelfCheckReport check(int threads = 2) const { return self_check(mesh, samples, lattice, Context(threads)); }
};

const auto everywhere = [](int) { return true; };
const auto on_it = [](double) { return 0.3; };

TEST(SelfCheck, FindsNothingOnAMeshThatHoldsItsSamples) {
  const SelfCheckReport report = Scene(30000, on_it, everywhere).check();
  EXPECT_EQ(report.lost, 0);
  EXPECT_EQ(report.invented, 0);
  EXPECT_GE(report.samples, 10000u);
  EXPECT_LE(report.samples, 20000u);
}

TEST(SelfCheck, SharesAreThoseOfAllSamplesAndTheWholeSurface) {
  // Samples climb away from the sheet; a fifth of it is missing.
  for (const size_t count : {size_t{9000}, size_t{90000}}) {
    const Scene scene(
        count, [](double x) { return 0.06 * x; }, [](int x) { return x < 20 || x >= 36; });
    const SelfCheckReport report = scene.check();
    size_t lost = 0;
    for (const double d : distances_to_mesh(scene.cloud.positions, scene.mesh, Context(2)))
      lost += d > self_check_reach * scene.lattice.voxel;
    const double share = static_cast<double>(lost) / static_cast<double>(count);
    if (count <= 20000)
      EXPECT_DOUBLE_EQ(report.lost, share);
    else
      EXPECT_NEAR(report.lost, share, 5 * std::sqrt(share / static_cast<double>(report.samples)));
    // The same of the surface, at its triangles' centers.
    size_t far = 0;
    for (const Triangle& t : scene.mesh.triangles) {
      const Vec3d sum = scene.mesh.vertices[t[0]] + scene.mesh.vertices[t[1]] + scene.mesh.vertices[t[2]];
      far += distance_to_samples(scene.samples, scene.lattice.to_lattice(sum / 3.0), 0, 20) > self_check_reach;
    }
    const double invented = static_cast<double>(far) / static_cast<double>(scene.mesh.triangles.size());
    EXPECT_GT(invented, 0.2);
    EXPECT_NEAR(report.invented, invented, 0.02);
  }
}

TEST(SelfCheck, WithoutSurfaceAllIsLost) {
  const SelfCheckReport report = Scene(1000, on_it, [](int) { return false; }).check();
  EXPECT_EQ(report.lost, 1);
  EXPECT_EQ(report.places, 0u);
}

TEST(SelfCheck, KnowsNoiseFromLostSurface) {
  Random random(3);
  for (const double deviation : {1.3, 2.0, 3.5}) {
    const Scene noisy(
        30000, [&](double) { return deviation * random.normal(); }, everywhere);
    const SelfCheckReport report = noisy.check();
    EXPECT_NEAR(report.lost, std::erfc(self_check_reach / deviation / std::sqrt(2.0)), 0.02) << deviation;
    EXPECT_NEAR(report.noise, deviation, 0.1 * deviation);
  }
  // A part of the sheet is missing, a twentieth or two fifths; moderate noise does not hide that.
  for (const int missing : {4, 32}) {
    const Scene scene(
        30000, [&](double) { return 0.7 * random.normal(); }, [=](int x) { return x >= missing; });
    const SelfCheckReport report = scene.check();
    EXPECT_GT(report.lost, self_check_most_lost);
    EXPECT_EQ(report.noise, 0) << missing;
  }
}

/// Both are lost and show no surface, but outliers have hardly any others around them.
TEST(SelfCheck, OutliersAreAloneAndLeavesAreNot) {
  for (const bool leaves : {false, true}) {
    Scene scene(20000, on_it, everywhere);
    Random random(6);
    for (int i = 0; i < 100; ++i) {
      Vec3d p{random.uniform(0, Scene::side), random.uniform(0, Scene::side), random.uniform(10, 25)};
      if (leaves) p = Vec3d{40, 40, 15} + 2.0 * Vec3d{random.normal(), random.normal(), random.normal()};
      scene.cloud.positions.push_back(scene.at(p.x, p.y, p.z));
      scene.cloud.normals.push_back({0, 0, 1});
    }
    scene.samples = sort_samples(scene.cloud, scene.cloud.normals, scene.lattice, Context(1));
    const SelfCheckReport report = scene.check();
    EXPECT_NEAR(report.lost, 100.0 / 20100, 0.002);
    EXPECT_GT(report.outliers, 0.9) << leaves;
    if (leaves)
      EXPECT_LT(report.alone, 0.1);
    else
      EXPECT_GT(report.alone, 0.9);
  }
}

TEST(SelfCheck, ThreadsDoNotMatter) {
  const Scene scene(
      50000, [](double x) { return 0.06 * x; }, everywhere);
  const SelfCheckReport one = scene.check(1), more = scene.check(5);
  EXPECT_EQ(one.lost, more.lost);
  EXPECT_EQ(one.invented, more.invented);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
