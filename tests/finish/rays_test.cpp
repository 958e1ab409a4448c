#include "soapfilm/finish/rays.h"

#include <gtest/gtest.h>

#include <numeric>

#include "soapfilm/core/random.h"
#include "support/flat_sheet.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr uint32_t side = 40;

Lattice lattice_of_voxels() {
  Lattice lattice;
  lattice.size = {side + 40, side + 40, side + 40};
  lattice.voxel = 1;
  lattice.first_vertex = {0, 0, 0};
  return lattice;
}

uint32_t sum(const std::vector<uint32_t>& counts) { return std::accumulate(counts.begin(), counts.end(), 0u); }

/// Rays straight down onto samples below a made-up sheet in the plane z = 0; each crosses it once.
std::vector<Ray> rays_through(size_t count, float from, float to) {
  Random random(7);
  std::vector<Ray> rays;
  for (size_t k = 0; k < count; ++k) {
    const auto x = static_cast<float>(random.uniform(1, side - 1)), y = static_cast<float>(random.uniform(1, side - 1));
    const Vec3f origin(lattice_of_voxels().to_lattice({0, 0, 0}));
    rays.push_back({origin + Vec3f{x, y, from}, origin + Vec3f{x + 0.3f, y - 0.2f, to}});
  }
  return rays;
}

TEST(Rays, EachCountsOnceWhereItCrossesMadeUpSurface) {
  const Mesh mesh = test::flat_sheet(side, {}, 1);
  const std::vector<double> made_up(mesh.vertices.size(), 2);
  const Lattice lattice = lattice_of_voxels();
  const std::vector<Ray> rays = rays_through(500, -20, 30);
  for (const int threads : {1, 3}) {
    const auto counts = count_crossings(mesh, made_up, rays, lattice, Context(threads));
    ASSERT_EQ(counts.size(), mesh.vertices.size());
    EXPECT_EQ(sum(counts), 500u);
  }
}

TEST(Rays, SurfaceThatSamplesSupportAndTheFirstVoxelsDoNotCount) {
  const Mesh mesh = test::flat_sheet(side, {}, 1);
  const Lattice lattice = lattice_of_voxels();
  const std::vector<double> seen(mesh.vertices.size(), 0.5), made_up(mesh.vertices.size(), 2);
  EXPECT_EQ(sum(count_crossings(mesh, seen, rays_through(50, -20, 30), lattice, Context(1))), 0u);
  EXPECT_EQ(sum(count_crossings(mesh, made_up, rays_through(50, -2, 30), lattice, Context(1))), 0u) << "noise";
  EXPECT_EQ(sum(count_crossings(mesh, made_up, rays_through(50, 5, 30), lattice, Context(1))), 0u) << "behind";
}

TEST(Rays, GoToTheScannerOfTheSampleItsScanOrTheOneForAll) {
  PointCloud cloud;
  cloud.positions = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  cloud.scans = {{"a", 0, 1, Vec3d{0, 0, 9}, {}, {}}, {"b", 1, 3, {}, {}, {}}};
  const Lattice lattice = lattice_of_voxels();
  EXPECT_EQ(some_rays(cloud, {}, lattice, Context(1)).size(), 1u);
  EXPECT_EQ(some_rays(cloud, Vec3d{5, 5, 5}, lattice, Context(1)).size(), 3u);
  cloud.sensors.assign(3, Vec3d{7, 7, 7});
  const std::vector<Ray> rays = some_rays(cloud, {}, lattice, Context(1));
  ASSERT_EQ(rays.size(), 3u);
  double sum = 0;
  for (const Ray& ray : rays) {
    const Vec3d way = Vec3d(ray.scanner) - Vec3d(ray.sample);
    EXPECT_NEAR(norm(cross(way, Vec3d{1, 1, 1})), 0, 1e-4);
    sum += way.x;
  }
  EXPECT_NEAR(sum, 6 + 5 + 4, 1e-4);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
