#include "soapfilm/extract/cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "soapfilm/mesh/topology.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

Mesh sphere() { return make_shape("sphere")->tessellate(0.002); }

TEST(Cut, HalfASphereHasOneBorder) {
  Mesh mesh = sphere();
  const double area = mesh.area();
  const std::vector<Vec3d> places = mesh.vertices;
  const Vec3d middle = mesh.box().center();
  keep_triangles(mesh, [&](uint32_t v) { return places[v].x > middle.x; });
  const TopologyReport topology = check_topology(mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_FALSE(topology.closed());
  EXPECT_EQ(topology.components.size(), 1U);
  EXPECT_NEAR(mesh.area(), area / 2, 0.1 * area);
}

/// Whatever is kept, no vertex is left where two fans of triangles meet.
TEST(Cut, AnySelectionIsAManifoldWithBoundary) {
  for (const uint32_t stride : {2U, 3U, 5U, 7U}) {
    Mesh mesh = sphere();
    keep_triangles(mesh, [&](uint32_t v) { return (v * 2654435761U >> 16) % stride != 0; });
    ASSERT_FALSE(mesh.triangles.empty());
    EXPECT_TRUE(check_topology(mesh).manifold()) << stride;
    std::vector<bool> used(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles)
      for (const uint32_t v : t) used[v] = true;
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  }
}

TEST(Cut, KeepingAllChangesNothing) {
  Mesh mesh = sphere();
  const Mesh before = mesh;
  keep_triangles(mesh, [](uint32_t) { return true; });
  EXPECT_EQ(mesh.vertices.size(), before.vertices.size());
  EXPECT_EQ(mesh.triangles.size(), before.triangles.size());
  EXPECT_TRUE(check_topology(mesh).closed());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
