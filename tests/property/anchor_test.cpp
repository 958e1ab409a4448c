// A lattice anchored in the world: the same surface, wherever its tiles lie.
#include <gtest/gtest.h>

#include <cmath>

#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "support/problem.h"
#include "tools/evaluate/evaluate.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

double largest_distance_from(const Mesh& mesh, double radius) {
  double largest = 0;
  for (const Vec3d& v : mesh.vertices) largest = std::max(largest, std::abs(norm(v) - radius));
  return largest;
}

TEST(Anchor, GivesTheSameSurfaceAndVerticesOfTheGridAtWholeVoxels) {
  const PointCloud cloud = sampled("sphere", 64, 1);
  ReconstructParams params;
  const double voxel = cloud.box().longest() / 52;
  params.place.voxel = voxel;
  const Reconstruction free = reconstruct(cloud, params, one_thread);
  const double radius = norm(cloud.positions[0]), error = largest_distance_from(free.mesh, radius);
  for (const Vec3d anchor : {Vec3d{0, 0, 0}, {0.3, -17.2, 1e3}}) {
    params.place.anchor = anchor;
    const Reconstruction anchored = reconstruct(cloud, params, one_thread);
    EXPECT_LE(anchored.report.certificate.relative_gap(), params.solve.tolerance * 1.5);
    EXPECT_LE(largest_distance_from(anchored.mesh, radius), 1.5 * error + 0.02 * voxel);
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = (anchored.report.grid.first_vertex[axis] - anchor[axis]) / voxel;
      EXPECT_NEAR(steps, std::round(steps), 1e-6);
    }
  }
}

TEST(Anchor, OpenSurfacesEndAtTheirBoxToo) {
  PointCloud sheet;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      sheet.positions.push_back({0.1 * x, 0.1 * y, 0.3 * std::sin(0.1 * x) * std::cos(0.13 * y)});
      sheet.normals.push_back({0, 0, 1});
    }
  ReconstructParams params;
  params.border.outside = Border::open;
  params.place.voxel = 0.1;
  const Reconstruction free = reconstruct(sheet, params, one_thread);
  params.place.anchor = Vec3d{0.05, 0.02, -3.3};
  const Reconstruction anchored = reconstruct(sheet, params, one_thread);
  const auto count = static_cast<double>(free.mesh.triangles.size());
  EXPECT_NEAR(static_cast<double>(anchored.mesh.triangles.size()), count, 0.2 * count);
  for (const Vec3d& v : anchored.mesh.vertices)
    EXPECT_NEAR(v.z, 0.3 * std::sin(v.x) * std::cos(1.3 * v.y), 0.15) << v.x << " " << v.y;
}

TEST(Anchor, NeedsAVoxel) {
  const PointCloud cloud = sampled("sphere", 40, 1);
  ReconstructParams params;
  params.place.anchor = Vec3d{0, 0, 0};
  EXPECT_THROW(reconstruct(cloud, params, one_thread), ParameterError);
  params.place.voxel = 0.05;
  params.place.anchor = Vec3d{NAN, 0, 0};
  EXPECT_THROW(reconstruct(cloud, params, one_thread), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
