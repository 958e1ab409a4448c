#include "soapfilm/finish/vertex_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

/// By looking at all of them, in input units.
TEST(VertexEvidence, IsThatOfAllSamples) {
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
  const VertexEvidence found = vertex_evidence(mesh, samples, lattice, true, true, one_thread);
  ASSERT_EQ(found.distance.size(), mesh.vertices.size());
  ASSERT_EQ(found.support.size(), mesh.vertices.size());
  double most = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    double nearest = std::numeric_limits<double>::infinity();
    double near = 0, nearly = 0;  // within the radius, but for rounding
    for (const Vec3d& p : cloud.positions) {
      const double distance = norm(p - mesh.vertices[v]);
      nearest = std::min(nearest, distance);
      near += distance < 0.15 - 1e-6;
      nearly += distance < 0.15 + 1e-6;
    }
    const double disk = 3.141592653589793 * 1.5 * 1.5;
    EXPECT_NEAR(found.distance[v], nearest, 1e-6 * (1 + nearest));
    EXPECT_GE(found.support[v], near / disk - 1e-6);
    EXPECT_LE(found.support[v], nearly / disk + 1e-6);
    most = std::max(most, nearly);
  }
  EXPECT_GT(most, 1);
  const VertexEvidence same = vertex_evidence(mesh, samples, lattice, true, true, three_threads);
  EXPECT_EQ(same.distance, found.distance);
  EXPECT_EQ(same.support, found.support);
  EXPECT_TRUE(vertex_evidence(mesh, samples, lattice, false, true, one_thread).distance.empty());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
