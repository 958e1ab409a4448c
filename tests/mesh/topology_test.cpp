#include "soapfilm/mesh/topology.h"

#include <gtest/gtest.h>

#include "soapfilm/error.h"

namespace soapfilm {
namespace TEST_FILE {

Mesh tetrahedron(Vec3d at = {}) {
  Mesh mesh;
  mesh.vertices = {at, at + Vec3d{1, 0, 0}, at + Vec3d{0, 1, 0}, at + Vec3d{0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

void append(Mesh& mesh, Mesh other) {  // by value: a mesh may be appended to itself
  const auto shift = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
}

/// A torus of rows x columns quads, each cut in two.
Mesh torus(uint32_t rows, uint32_t columns) {
  Mesh mesh;
  const double tau = 6.283185307179586;
  for (uint32_t i = 0; i < rows; ++i) {
    for (uint32_t j = 0; j < columns; ++j) {
      const double a = tau * i / rows;
      const double b = tau * j / columns;
      mesh.vertices.push_back({(2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b)});
      const auto at = [&](uint32_t r, uint32_t c) { return r % rows * columns + c % columns; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(Topology, TetrahedronIsASphere) {
  const TopologyReport report = check_topology(tetrahedron());
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.edges, 6u);
  EXPECT_EQ(report.euler_characteristic(), 2);
  EXPECT_EQ(report.genus(), 0);
  EXPECT_EQ(summary(report), "closed, manifold, 1 component, genus 0");
}

TEST(Topology, TorusHasOneHandle) {
  const Mesh mesh = torus(20, 13);
  const TopologyReport report = check_topology(mesh);
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.genus(), 1);
  EXPECT_GT(mesh.volume(), 0);
}

TEST(Topology, GenusIsListedPerComponentInTheOrderOfVertices) {
  Mesh mesh = torus(5, 4);
  append(mesh, tetrahedron({9, 0, 0}));
  const TopologyReport report = check_topology(mesh);
  ASSERT_EQ(report.components.size(), 2u);
  EXPECT_EQ(report.components[0].genus(), 1);
  EXPECT_EQ(report.components[1].genus(), 0);
  EXPECT_EQ(report.components[1].triangles, 4u);
  EXPECT_EQ(report.genus(), 1);
}

TEST(Topology, AMissingTriangleLeavesThreeBoundaryEdges) {
  Mesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  const TopologyReport report = check_topology(mesh);
  EXPECT_EQ(report.boundary_edges, 3u);
  EXPECT_FALSE(report.closed());
  EXPECT_TRUE(report.manifold());
  EXPECT_EQ(report.genus(), std::nullopt);
}

TEST(Topology, AFlippedTriangleIsMisoriented) {
  Mesh mesh = tetrahedron();
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  const TopologyReport report = check_topology(mesh);
  EXPECT_EQ(report.misoriented_edges, 3u);
  EXPECT_TRUE(report.closed());
  EXPECT_FALSE(report.manifold());
}

TEST(Topology, TwoTetrahedraSharingAnEdge) {
  Mesh mesh = tetrahedron();
  append(mesh, tetrahedron({0, 0, -3}));
  for (Triangle& t : mesh.triangles) {
    for (uint32_t& v : t) v = v == 4 ? 0 : v == 5 ? 1 : v;
  }
  const TopologyReport report = check_topology(mesh);
  EXPECT_EQ(report.non_manifold_edges, 1u);
  EXPECT_EQ(report.unreferenced_vertices, 2u);
  EXPECT_EQ(report.components.size(), 1u);
  EXPECT_FALSE(report.manifold());
}

TEST(Topology, TwoTetrahedraSharingAVertexHaveTwoFansThere) {
  Mesh mesh = tetrahedron();
  append(mesh, tetrahedron({0, 0, -3}));
  for (Triangle& t : mesh.triangles) {
    for (uint32_t& v : t) v = v == 4 ? 0 : v;
  }
  const TopologyReport report = check_topology(mesh);
  EXPECT_EQ(report.non_manifold_vertices, 1u);
  EXPECT_EQ(report.non_manifold_edges, 0u);
  EXPECT_FALSE(report.manifold());
  EXPECT_FALSE(report.components[0].closed_manifold);
}

TEST(Topology, AHubOfHighValenceIsOneFanAndTwoHubsGluedAreTwo) {
  const uint32_t spokes = 500;
  Mesh mesh;
  mesh.vertices = {{0, 0, 1}, {0, 0, -1}};
  for (uint32_t i = 0; i < spokes; ++i) {
    const double a = 6.283185307179586 * i / spokes;
    mesh.vertices.push_back({std::cos(a), std::sin(a), 0});
    mesh.triangles.push_back({0, 2 + i, 2 + (i + 1) % spokes});
    mesh.triangles.push_back({1, 2 + (i + 1) % spokes, 2 + i});
  }
  EXPECT_TRUE(check_topology(mesh).watertight());
  const auto second = static_cast<uint32_t>(mesh.vertices.size());
  append(mesh, mesh);
  for (Triangle& t : mesh.triangles) {
    for (uint32_t& v : t) v = v == second ? 0 : v;
  }
  EXPECT_EQ(check_topology(mesh).non_manifold_vertices, 1u);
}

TEST(Topology, DuplicatesAreFoundInAnyRotationAndOrientation) {
  Mesh mesh = tetrahedron();
  mesh.triangles.push_back({1, 0, 2});
  mesh.triangles.push_back({1, 2, 0});
  const TopologyReport report = check_topology(mesh);
  EXPECT_EQ(report.duplicate_triangles, 2u);
  EXPECT_EQ(report.non_manifold_edges, 3u);
}

TEST(Topology, DegenerateAndZeroAreaTrianglesAreDifferentThings) {
  Mesh mesh = tetrahedron();
  mesh.triangles.push_back({1, 1, 2});
  mesh.vertices.push_back({0.1, 0.1, 0.1});
  mesh.vertices.push_back({0.2, 0.2, 0.2});
  mesh.vertices.push_back({0.7, 0.7, 0.7});
  mesh.triangles.push_back({4, 5, 6});
  const TopologyReport report = check_topology(mesh);
  EXPECT_EQ(report.degenerate_triangles, 1u);
  EXPECT_EQ(report.zero_area_triangles, 1u);
  EXPECT_EQ(report.boundary_edges, 3u);
}

TEST(Topology, SliversThatMarchingCubesMayMakeHaveAnArea) {
  Mesh mesh = tetrahedron({5e6, 5e6, 5e6});
  for (Vec3d& v : mesh.vertices) v = Vec3d{5e6, 5e6, 5e6} + (v - Vec3d{5e6, 5e6, 5e6}) * 1e-6;
  EXPECT_EQ(check_topology(mesh).zero_area_triangles, 0u);
}

TEST(Topology, AnEmptyMeshIsNotClosed) {
  const TopologyReport report = check_topology(Mesh{});
  EXPECT_FALSE(report.closed());
  EXPECT_FALSE(report.watertight());
  EXPECT_TRUE(report.components.empty());
}

TEST(Topology, AVertexThatDoesNotExistIsRefused) {
  Mesh mesh = tetrahedron();
  mesh.triangles[1][2] = 4;
  EXPECT_THROW(check_topology(mesh), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
