#include "tools/mesh/self_intersection.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

size_t count(const Mesh& mesh) { return count_self_intersections(mesh, Context(1)); }

/// Corners of a cube; the tetrahedra of its even and of its odd ones form the stella octangula.
Mesh tetrahedron(bool odd, Vec3d shift = {}) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    if (((x + y + z) % 2 == 1) == odd)
      mesh.vertices.push_back(Vec3d{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)} + shift);
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return mesh;
}

Mesh together(Mesh a, const Mesh& b) {
  const auto offset = static_cast<uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

TEST(SelfIntersection, ThereIsNoneInATetrahedron) { EXPECT_EQ(count(tetrahedron(false)), 0u); }

TEST(SelfIntersection, TwoTetrahedraThatCrossAtOneCorner) {
  // A corner poked through one face: its three faces cross that one.
  Mesh pyramid;
  pyramid.vertices = {{0.3, 0.3, -0.2}, {0.1, 0.1, 2}, {0.6, 0.1, 2}, {0.1, 0.6, 2}};
  pyramid.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  Mesh face;
  face.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -5}};
  face.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  EXPECT_EQ(count(together(pyramid, face)), 3u);
}

TEST(SelfIntersection, StellaOctangula) {
  // Each face of one crosses the three faces of the other that meet at the corner above it, and touches the fourth,
  // which is parallel to it, nowhere.
  EXPECT_EQ(count(together(tetrahedron(false), tetrahedron(true))), 12u);
}

TEST(SelfIntersection, CoplanarOverlapAndFoldsCount) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, 0}, {3, 0.5, 0}, {3, 3, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(count(mesh), 1u) << "coplanar, a corner inside";
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.4, 0.3, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(count(mesh), 1u) << "folded back along an edge";
  mesh.vertices[3] = {0.4, -0.3, 0};
  EXPECT_EQ(count(mesh), 0u) << "flat neighbors";
  mesh.vertices[3] = {0.4, 0.3, 1e-9};
  EXPECT_EQ(count(mesh), 0u) << "almost folded";
  mesh.triangles = {{0, 1, 2}, {0, 1, 2}};
  EXPECT_EQ(count(mesh), 1u) << "the same twice";
}

TEST(SelfIntersection, NeighborsAtACornerMayCross) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {1, 0, -1}, {1, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(count(mesh), 1u);
  mesh.vertices[3] = {-1, 0, -1};
  mesh.vertices[4] = {-1, 0, 1};
  EXPECT_EQ(count(mesh), 0u) << "they only share the corner";
}

TEST(SelfIntersection, EdgesAndCornersThatTouchCount) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}, {0.5, -1, 1}, {0.5, -1, -1}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(count(mesh), 1u) << "a corner on an edge";
  mesh.vertices[3].y = -1e-6;
  EXPECT_EQ(count(mesh), 0u);
}

TEST(SelfIntersection, VerticesAtOnePlaceAreOne) {
  // A surface as STL has it: every triangle with corners of its own.
  const Mesh whole = make_torus()->tessellate(1e-3);
  Mesh soup;
  for (const Triangle& t : whole.triangles) {
    for (const uint32_t v : t) soup.vertices.push_back(whole.vertices[v]);
    const auto end = static_cast<uint32_t>(soup.vertices.size());
    soup.triangles.push_back({end - 3, end - 2, end - 1});
  }
  EXPECT_EQ(count(soup), 0u);
}

TEST(SelfIntersection, ThereIsNoneInAnyShape) {
  for (const std::string& name : shape_names()) EXPECT_EQ(count(make_shape(name)->tessellate(1e-3)), 0u) << name;
}

/// Moeller and Trumbore's test in double of each edge against the other triangle: enough in general position.
bool crosses(Vec3d p, Vec3d q, const std::array<Vec3d, 3>& t) {
  const auto volume = [](Vec3d a, Vec3d b, Vec3d c, Vec3d d) { return dot(cross(b - a, c - a), d - a); };
  if (volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) > 0) return false;
  const double a = volume(p, q, t[0], t[1]), b = volume(p, q, t[1], t[2]), c = volume(p, q, t[2], t[0]);
  return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

TEST(SelfIntersection, EqualsBruteForceOnRandomTriangles) {
  Random random(3);
  Mesh soup;
  const auto vector = [&](double scale) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    return Vec3d{x, y, z} * scale;
  };
  for (uint32_t i = 0; i < 500; ++i) {
    const Vec3d center = vector(1);
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(center + vector(i % 50 == 0 ? 1.0 : 0.15));
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  size_t expected = 0;
  for (uint32_t i = 0; i < 500; ++i) {
    for (uint32_t j = i + 1; j < 500; ++j) {
      const std::array<Vec3d, 3> a{soup.vertices[3 * i], soup.vertices[3 * i + 1], soup.vertices[3 * i + 2]};
      const std::array<Vec3d, 3> b{soup.vertices[3 * j], soup.vertices[3 * j + 1], soup.vertices[3 * j + 2]};
      bool meet = false;
      for (int k = 0; k < 3; ++k) meet |= crosses(a[k], a[(k + 1) % 3], b) || crosses(b[k], b[(k + 1) % 3], a);
      expected += meet ? 1 : 0;
    }
  }
  EXPECT_GE(expected, 100u);
  EXPECT_EQ(count(soup), expected);
  for (const int threads : {2, 5}) EXPECT_EQ(count_self_intersections(soup, Context(threads)), expected);
  for (Vec3d& v : soup.vertices) v = v * 1e-3 + Vec3d{5e6, -5e6, 5e6};
  EXPECT_NEAR(static_cast<double>(count(soup)), static_cast<double>(expected), 3) << "far from the origin";
}

TEST(SelfIntersection, NothingToCount) {
  EXPECT_EQ(count({}), 0u);
  Mesh mesh = tetrahedron(false);
  for (Vec3d& v : mesh.vertices) v = {1, 2, 3};
  EXPECT_EQ(count(mesh), 0u) << "no triangle has area";
}

TEST(SelfIntersection, RefusesWhatIsNoMesh) {
  Mesh mesh = tetrahedron(false);
  mesh.triangles[1][1] = 9;
  EXPECT_THROW(count(mesh), ParameterError);
  mesh = tetrahedron(false);
  mesh.vertices[0].x = NAN;
  EXPECT_THROW(count(mesh), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
