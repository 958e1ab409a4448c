#include "soapfilm/finish/sample_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

/// By looking at all of them, in input units.
TEST(SampleDistance, IsThatOfTheNearestOne) {
  Random random(3);
  PointCloud cloud;
  const Vec3d offset{1e5, -2e5, 30};
  for (int i = 0; i < 400; ++i)
    cloud.positions.push_back(offset + Vec3d{random.uniform(), 2 * random.uniform(), 5 * random.uniform()});
  cloud.scans.push_back({"cloud", 0, cloud.size(), {}, {}, {}});
  const std::vector<Vec3f> directions(cloud.size(), Vec3f{0, 0, 1});
  const Lattice lattice = place_lattice(cloud.box(), 0.1, 6);
  const Context one_thread(1), three_threads(3);
  const GridSamples samples = sort_samples(cloud, directions, lattice, one_thread);
  Mesh mesh;
  for (int i = 0; i < 3000; ++i)
    mesh.vertices.push_back(offset + Vec3d{random.uniform(-2, 3), random.uniform(-2, 4), random.uniform(-9, 14)});
  const std::vector<float> distances = distances_to_samples(mesh, samples, lattice, one_thread);
  ASSERT_EQ(distances.size(), mesh.vertices.size());
  for (size_t v = 0; v < distances.size(); ++v) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3d& p : cloud.positions) nearest = std::min(nearest, norm(p - mesh.vertices[v]));
    EXPECT_NEAR(distances[v], nearest, 1e-6 * (1 + nearest));
  }
  EXPECT_EQ(distances_to_samples(mesh, samples, lattice, three_threads), distances);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
