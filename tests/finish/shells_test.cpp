#include "soapfilm/finish/shells.h"

#include <gtest/gtest.h>

#include <utility>

#include "soapfilm/core/vec.h"
#include "soapfilm/mesh/topology.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

/// A ball whose faces look outward or inward.
void add_ball(Mesh& mesh, Vec3d center, double radius, bool outward) {
  ShapeParams params;
  params.size = 2 * radius;
  params.center = center;
  const Mesh ball = make_sphere(params)->tessellate(0.02 * radius);
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), ball.vertices.begin(), ball.vertices.end());
  for (Triangle t : ball.triangles) {
    if (!outward) std::swap(t[1], t[2]);
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

TEST(Shells, BubblesThatNobodySawFromWithinGo) {
  const Vec3d far{5e6, -4e6, 300};  // the sign of a volume must not depend on the origin
  Mesh mesh;
  add_ball(mesh, far, 1, true);
  const Mesh alone = mesh;
  add_ball(mesh, far + Vec3d{3, 0, 0}, 0.5, false);
  add_ball(mesh, far + Vec3d{-3, 0, 0}, 0.3, false);
  EXPECT_EQ(drop_shells(mesh), 2u);
  EXPECT_EQ(mesh.triangles.size(), alone.triangles.size());
  EXPECT_EQ(mesh.area(), alone.area());
  for (const Vec3d& v : mesh.vertices) EXPECT_LT(norm(v - far), 1.01);
  EXPECT_TRUE(check_topology(mesh).closed());
}

TEST(Shells, BodiesStay) {
  Mesh mesh;
  for (const double radius : {1.0, 0.5, 0.1}) add_ball(mesh, {10 * radius, 0, 0}, radius, true);
  const Mesh before = mesh;
  EXPECT_EQ(drop_shells(mesh), 0u);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

/// A room seen from within is inside out as well, but it is what was scanned.
TEST(Shells, ARoomThatIsMostOfTheMeshStays) {
  Mesh mesh;
  add_ball(mesh, {}, 1, false);
  add_ball(mesh, {0.4, 0, 0}, 0.2, true);
  add_ball(mesh, {2, 0, 0}, 0.3, false);
  EXPECT_EQ(drop_shells(mesh), 1u);
  const TopologyReport topology = check_topology(mesh);
  EXPECT_EQ(topology.components.size(), 2u);
  for (const Vec3d& v : mesh.vertices) EXPECT_LT(norm(v), 1.01);
}

/// What has a border is no shell, whatever its faces enclose.
TEST(Shells, OpenPartsStay) {
  Mesh mesh;
  add_ball(mesh, {}, 1, true);
  add_ball(mesh, {3, 0, 0}, 0.5, false);
  mesh.triangles.pop_back();
  const size_t before = mesh.triangles.size();
  EXPECT_EQ(drop_shells(mesh), 0u);
  EXPECT_EQ(mesh.triangles.size(), before);
}

TEST(Shells, NothingComesOfNothing) {
  Mesh mesh;
  EXPECT_EQ(drop_shells(mesh), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
