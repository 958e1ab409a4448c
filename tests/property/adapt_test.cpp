// Levels that adapt to the samples' density.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/reconstruct.h"
#include "support/sanitized.h"
#include "tools/mesh/self_intersection.h"

namespace soapfilm {
namespace TEST_FILE {

/// A unit ball whose density falls by `decades` powers of ten from one pole to the other.
PointCloud uneven_ball(size_t samples, double decades) {
  Random random(1);
  PointCloud cloud;
  while (cloud.size() < samples) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    const Vec3d p = normalized(Vec3d{x, y, z});
    if (random.uniform() >= std::pow(10, -decades * (1 - p.z) / 2)) continue;
    cloud.positions.push_back(p);
    cloud.normals.push_back(Vec3f(p));
  }
  return cloud;
}

struct Errors {
  double mean = 0, most = 0;  ///< of the vertices, voxels
};
Errors errors_of(const Reconstruction& result) {
  Errors errors;
  for (const Vec3d p : result.mesh.vertices) {
    const double error = std::abs(norm(p) - 1) / result.report.grid.voxel;
    errors.mean += error / static_cast<double>(result.mesh.vertices.size());
    errors.most = std::max(errors.most, error);
  }
  return errors;
}

Reconstruction reconstructed(const PointCloud& cloud, bool adapt, int threads = 2) {
  ReconstructParams params;
  params.place.adapt = adapt;
  return reconstruct(cloud, params, Context(threads));
}

/// A thousand to one: a voxel that suits the dense pole is far too small for the other one.
TEST(Adapt, ABallOfUnevenDensityIsWholeAndRound) {
  const PointCloud cloud = test::sanitized ? uneven_ball(8000, 2) : uneven_ball(60000, 3);
  const Reconstruction even = reconstructed(cloud, false), adapted = reconstructed(cloud, true);
  const TopologyReport topology = check_topology(adapted.mesh);
  EXPECT_TRUE(topology.closed() && topology.manifold());
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_EQ(count_self_intersections(adapted.mesh, Context(1)), 0u);
  const Errors before = errors_of(even), after = errors_of(adapted);
  EXPECT_LT(after.mean, 0.02);
  EXPECT_LT(after.most, 2);
  if (!test::sanitized) {
    EXPECT_GT(before.most, 4);
  }
  EXPECT_LT(adapted.mesh.triangles.size(),
            (test::sanitized ? 1 : 0.9) * static_cast<double>(even.mesh.triangles.size()));
}

/// Three levels and their borders, for any number of threads.
TEST(Adapt, ThreadsDoNotMatter) {
  const PointCloud cloud = uneven_ball(8000, 3);
  const Mesh one = reconstructed(cloud, true, 1).mesh, many = reconstructed(cloud, true, 3).mesh;
  EXPECT_EQ(one.vertices, many.vertices);
  EXPECT_EQ(one.triangles, many.triangles);
}

/// Nothing is coarse where nothing is sparse.
TEST(Adapt, AnEvenBallHasOneLevel) {
  const PointCloud cloud = uneven_ball(8000, 0);
  const Errors even = errors_of(reconstructed(cloud, false)), adapted = errors_of(reconstructed(cloud, true));
  EXPECT_NEAR(adapted.mean, even.mean, 0.1 * even.mean);
  EXPECT_NEAR(adapted.most, even.most, 0.3 * even.most);
}

TEST(Adapt, NeedsDistances) {
  const PointCloud cloud = uneven_ball(1000, 0);
  ReconstructParams params;
  params.place.adapt = true;
  params.surface.refine = false;
  EXPECT_THROW(reconstruct(cloud, params, Context(1)), ParameterError);
  params.surface.refine.reset();
  params.method = Method::poisson;
  EXPECT_THROW(reconstruct(cloud, params, Context(1)), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
