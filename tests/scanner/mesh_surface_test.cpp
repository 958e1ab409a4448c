#include "tools/scanner/mesh_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(MeshSurface, AgreesWithTheSphereThatItTessellates) {
  const auto sphere = make_sphere({.size = 2.0});
  const double tolerance = 1e-4;
  const MeshSurface mesh(sphere->tessellate(tolerance), Context(1));
  ScannerParams params;
  params.views = 5;
  params.columns = params.rows = 80;
  params.max_incidence_deg = 70;
  const Context context(2);
  const ScanSet exact = virtual_scan(*sphere, params, context);
  const ScanSet meshed = virtual_scan(mesh, params, context);
  ASSERT_EQ(exact.cloud.scans.size(), meshed.cloud.scans.size());
  size_t compared = 0;
  for (size_t k = 0; k < exact.cloud.scans.size(); ++k) {
    const Scan& a = exact.cloud.scans[k];
    const Scan& b = meshed.cloud.scans[k];
    ASSERT_EQ(a.range_grid->sample.size(), b.range_grid->sample.size());
    for (size_t i = 0; i < a.range_grid->sample.size(); ++i) {
      const int32_t s = a.range_grid->sample[i], t = b.range_grid->sample[i];
      if (s < 0 || t < 0) continue;  // one of them just beyond the largest angle
      ++compared;
      // Chords deviate by the tolerance, a slanted ray sees it longer: by 1 / cos(70 degrees).
      ASSERT_LE(norm(exact.cloud.positions[a.begin + s] - meshed.cloud.positions[b.begin + t]), 3.2 * tolerance);
    }
  }
  EXPECT_GT(compared, exact.cloud.size() * 99 / 100);
}

TEST(MeshSurface, ClosestPointMatchesBruteForce) {
  const auto shape = make_part();
  const MeshSurface surface(shape->tessellate(3e-4), Context(1));
  const Mesh& mesh = surface.mesh();
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const Vec3d p{x, y, z};
    // The distance to any point of the mesh is at least the answer; at the answer itself it is reached.
    const SurfacePoint closest = surface.closest(p);
    ASSERT_NEAR(norm(closest.position - p), closest.distance, 1e-13);
    ASSERT_LE(surface.distance(closest.position), 1e-13);
    for (const Triangle& t : mesh.triangles) {
      for (const Vec3d& w : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{0.5, 0.5, 0}, Vec3d{0, 0.5, 0.5},
                             Vec3d{0.2, 0.3, 0.5}}) {
        const Vec3d q = mesh.vertices[t[0]] * w.x + mesh.vertices[t[1]] * w.y + mesh.vertices[t[2]] * w.z;
        ASSERT_GE(norm(p - q), closest.distance - 1e-13);
      }
    }
    ASSERT_NEAR(closest.distance, shape->distance(p), 3e-4);
  }
}

TEST(MeshSurface, HitsLieOnTheMeshWhateverItsOffset) {
  Mesh mesh = make_knot()->tessellate(1e-3);
  for (Vec3d& v : mesh.vertices) v = v * 1e-1 + Vec3d{5e6, 5e6, 100.0};
  const MeshSurface surface(mesh, Context(1));
  ScannerParams params;
  params.views = 3;
  params.columns = params.rows = 60;
  const ScanSet set = virtual_scan(surface, params, Context(2));
  ASSERT_GT(set.cloud.size(), 1000u);
  for (const Vec3d& p : set.cloud.positions)
    ASSERT_LE(surface.distance(p), 2e-9);  // two units in the last place of 5e6
}

TEST(MeshSurface, TurnsAnInsideOutMesh) {
  Mesh mesh = make_torus()->tessellate(1e-3);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  ASSERT_LT(mesh.volume(), 0.0);
  const MeshSurface surface(mesh, Context(1));
  EXPECT_TRUE(surface.reversed());
  EXPECT_GT(surface.mesh().volume(), 0.0);
  const auto hit = surface.intersect({-3.0, 0.01, 0.01}, {1.0, 0.0, 0.0});
  ASSERT_TRUE(hit);
  EXPECT_LT(hit->normal.x, -0.9);
  EXPECT_FALSE(MeshSurface(surface.mesh(), Context(1)).reversed());
}

/// Two triangles in a plane that no axis lies in.
Mesh tilted_sheet() {
  Mesh mesh;
  const Vec3d corner{0.1, 0.2, 0.7}, along{0.3, 0.9, 0.4}, across{-0.8, 0.1, 0.55};
  mesh.vertices = {corner, corner + along, corner + along + across, corner + across};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A cube without its lid; outward, or as a room is scanned.
Mesh open_box() {
  Mesh mesh;
  for (uint32_t i = 0; i < 8; ++i) mesh.vertices.push_back({1.0 * (i & 1), 1.0 * (i >> 1 & 1), 1.0 * (i >> 2)});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7},
                    {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// It has no inside: the sign of its volume would be rounding's, or its shape's.
TEST(MeshSurface, AnOpenMeshIsTakenAsItIs) {
  for (Mesh mesh : {tilted_sheet(), open_box()}) {
    int negative = 0;
    for (const bool reversed : {false, true}) {
      if (reversed)
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
      negative += mesh.volume() < 0.0;
      const MeshSurface surface(mesh, Context(1));
      EXPECT_FALSE(surface.reversed());
      EXPECT_FALSE(surface.volume());
      EXPECT_EQ(surface.mesh().triangles, mesh.triangles);
      const Triangle& t = mesh.triangles[0];
      const Vec3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
      EXPECT_EQ(surface.closest((a + b + c) / 3.0).normal, normalized(cross(b - a, c - a)));
    }
    EXPECT_EQ(negative, 1) << "one orientation has a volume below zero";
  }
}

TEST(MeshSurface, AClosedMeshHasItsVolume) {
  const Mesh mesh = make_torus()->tessellate(1e-3);
  EXPECT_EQ(MeshSurface(mesh, Context(1)).volume(), mesh.volume());
}

TEST(MeshSurface, SamplesLieOnTheMesh) {
  const MeshSurface surface(make_part()->tessellate(1e-3), Context(1));
  const PointCloud cloud = sample_surface(surface, 2000, 3);
  for (size_t i = 0; i < cloud.size(); ++i) ASSERT_LE(surface.distance(cloud.positions[i]), 1e-13);
}

TEST(MeshSurface, RefusesWhatIsNoMesh) {
  const auto message = [](const Mesh& mesh) -> std::string {
    try {
      const MeshSurface surface(mesh, Context(1));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  Mesh mesh;
  EXPECT_EQ(message(mesh), "mesh: 0 triangles, must have at least one");
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 3}};
  EXPECT_EQ(message(mesh), "mesh: triangle 0 names vertex 3, must be < 3");
  mesh.triangles = {{0, 1, 2}};
  mesh.vertices[1].y = INFINITY;
  EXPECT_EQ(message(mesh), "mesh: vertex 1 is not finite");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
