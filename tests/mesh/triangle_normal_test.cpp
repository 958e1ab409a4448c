#include "soapfilm/mesh/triangle_normal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace soapfilm {
namespace TEST_FILE {

Mesh one_triangle(Vec3d a, Vec3d b, Vec3d c) {
  Mesh mesh;
  mesh.vertices = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Corners on a skew line, the third at `part` of the side, but for `height` beside it.
Mesh sliver(double height, double part = 0.3) {
  const Vec3d along = normalized(Vec3d{0.3, -0.7, 1.1}), side = normalized(cross(along, Vec3d{1, 0, 0}));
  const Vec3d a{0.1, 0.2, 0.7};
  return one_triangle(a, a + along, a + along * part + side * height);
}

TEST(TriangleNormal, IsUnitAndTurnsWithTheCorners) {
  const Mesh mesh = one_triangle({1, 0, 0}, {0, 2, 0}, {0, 0, 3});
  const Vec3d n = triangle_normal(mesh, 0);
  EXPECT_NEAR(norm(n), 1.0, 1e-15);
  for (const Vec3d& v : mesh.vertices) EXPECT_NEAR(dot(n, v - mesh.vertices[0]), 0.0, 1e-15);
  EXPECT_GT(n.x, 0.0);
  Mesh turned = mesh;
  turned.triangles = {{0, 2, 1}};
  EXPECT_EQ(triangle_normal(turned, 0), -n);
}

TEST(TriangleNormal, DoesNotDependOnTheScale) {
  const Mesh mesh = one_triangle({1, 0, 0}, {0, 2, 0}, {0, 0, 3});
  for (const double scale : {1e-30, 1e30}) {
    Mesh scaled = mesh;
    for (Vec3d& v : scaled.vertices) v = v * scale;
    EXPECT_NEAR(norm(triangle_normal(scaled, 0) - triangle_normal(mesh, 0)), 0.0, 1e-14) << scale;
  }
}

TEST(TriangleNormal, IsZeroWhereRoundingWouldChooseIt) {
  int rounded = 0;
  for (int i = 1; i < 50; ++i) {
    const Mesh flat = sliver(0.0, i / 50.0);
    const Vec3d a = flat.vertices[0];
    rounded += cross(flat.vertices[1] - a, flat.vertices[2] - a) != Vec3d{};
    EXPECT_EQ(triangle_normal(flat, 0), Vec3d{}) << i;
  }
  EXPECT_GT(rounded, 0) << "some are not flat to the last bit";
  EXPECT_EQ(triangle_normal(one_triangle({1, 2, 3}, {1, 2, 3}, {1, 2, 3}), 0), Vec3d{});
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(triangle_normal(one_triangle({1, 2, 3}, {1, nan, 3}, {0, 0, 3}), 0), Vec3d{});
}

TEST(TriangleNormal, ThinTrianglesHaveOne) {
  for (const double height : {1e-3, 1e-6, 1e-9}) {
    const Mesh thin = sliver(height);
    const Vec3d n = triangle_normal(thin, 0);
    EXPECT_NEAR(norm(n), 1.0, 1e-15) << height;
    EXPECT_NEAR(dot(n, triangle_normal(sliver(1.0), 0)), 1.0, 1e-6) << height;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
