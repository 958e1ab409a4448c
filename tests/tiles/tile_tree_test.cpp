// Laws of tilesets: whatever tiles a viewer shows, they make one surface without a crack, as near as it is told.
#include "tools/tiles/tile_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "relax/grid_torus.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "support/farthest.h"
#include "support/flat_sheet.h"
#include "support/sanitized.h"
#include "tools/tiles/tile_part.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context two_threads(2);

Mesh wavy_torus(uint32_t n) {
  Mesh mesh = grid_torus({0, 0, 0}, 2, 0.7, 2 * n, n);
  for (Vec3d& v : mesh.vertices) v.z += 0.05 * std::sin(9 * v.x) * std::cos(7 * v.y);
  return mesh;
}

Mesh hills(uint32_t n) {
  Mesh mesh = flat_sheet(n, {1000, 2000, 30}, 0.5);
  for (Vec3d& v : mesh.vertices) v.z += std::sin(0.3 * v.x) * std::cos(0.2 * v.y);
  return mesh;
}

/// Vertices at the very same place are one.
Mesh welded(const std::vector<const Mesh*>& parts) {
  Mesh all;
  std::map<std::tuple<double, double, double>, uint32_t> at;
  for (const Mesh* part : parts) {
    std::vector<uint32_t> number;
    for (const Vec3d& v : part->vertices) {
      const auto [found, is_new] = at.try_emplace({v.x, v.y, v.z}, static_cast<uint32_t>(all.vertices.size()));
      if (is_new) all.vertices.push_back(v);
      number.push_back(found->second);
    }
    for (const Triangle& t : part->triangles) all.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return all;
}

/// What a viewer may show: each tile or its children, as it likes.
struct View {
  std::vector<const Mesh*> meshes;
  double error = 0;

  View(const TileTree& tree, double finer, uint64_t seed) {
    Random random(seed);
    std::vector<size_t> open{tree.tiles.size() - 1};
    while (!open.empty()) {
      const Tile& tile = tree.tiles[open.back()];
      open.pop_back();
      if (!tile.children.empty() && random.uniform() < finer) {
        open.insert(open.end(), tile.children.begin(), tile.children.end());
        continue;
      }
      meshes.push_back(&tile.mesh);
      error = std::max(error, tile.error);
    }
  }
};

TEST(TileTree, AnyMixOfLevelsIsClosedWhereTheMeshIs) {
  const Mesh mesh = wavy_torus(sanitized ? 40 : 120);
  const TileTree tree = make_tiles(mesh, {.triangles = 500}, two_threads);
  ASSERT_GT(tree.tiles.size(), 8u);
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const View view(tree, seed == 1 ? 0 : seed == 2 ? 1 : 0.6, seed);
    const TopologyReport topology = check_topology(welded(view.meshes));
    EXPECT_EQ(topology.boundary_edges, 0u) << seed;
    EXPECT_EQ(topology.non_manifold_edges, 0u) << seed;
    EXPECT_EQ(topology.misoriented_edges, 0u) << seed;
    EXPECT_EQ(topology.components.size(), 1u) << seed;
    EXPECT_EQ(topology.genus(), 1) << seed;
  }
}

/// An open mesh has its own border on each level, and no other.
TEST(TileTree, AnyMixOfLevelsOfAnOpenMeshHasOneBorder) {
  const Mesh mesh = hills(sanitized ? 40 : 100);
  const TileTree tree = make_tiles(mesh, {.triangles = 500}, two_threads);
  ASSERT_GT(tree.tiles.size(), 8u);
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const TopologyReport topology = check_topology(welded(View(tree, seed == 1 ? 0 : 0.6, seed).meshes));
    EXPECT_TRUE(topology.manifold()) << seed;
    EXPECT_EQ(topology.components.size(), 1u) << seed;
    EXPECT_EQ(topology.euler_characteristic(), 1) << "a disk: " << seed;
  }
}

TEST(TileTree, ErrorsBoundTheDistanceBothWays) {
  const Mesh mesh = wavy_torus(sanitized ? 30 : 80);
  const TileTree tree = make_tiles(mesh, {.triangles = 300}, two_threads);
  EXPECT_GT(tree.root().error, 0);
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const View view(tree, seed == 1 ? 0 : 0.5, seed);
    const Mesh shown = welded(view.meshes);
    const double most = farthest_between(mesh, shown, two_threads);
    EXPECT_LE(most, view.error);
    if (seed == 1) {
      EXPECT_GT(most, 0.05 * view.error) << "the bound is not far off";
    }
  }
}

TEST(TileTree, CoarserTilesHaveFewerTrianglesAndLargerErrors) {
  const Mesh mesh = wavy_torus(sanitized ? 40 : 120);
  const TileTree tree = make_tiles(mesh, {.triangles = 500}, two_threads);
  size_t of_leaves = 0;
  for (const Tile& tile : tree.tiles) {
    size_t below = 0;
    for (const size_t child : tile.children) {
      below += tree.tiles[child].mesh.triangles.size();
      EXPECT_GE(tile.error, tree.tiles[child].error);
      EXPECT_EQ(tree.tiles[child].depth, tile.depth + 1);
      EXPECT_EQ(tree.tiles[child].cell.x >> 1, tile.cell.x);
    }
    if (tile.children.empty()) {
      of_leaves += tile.mesh.triangles.size();
      EXPECT_LE(tile.mesh.triangles.size(), 500u);
    } else {
      EXPECT_LE(tile.mesh.triangles.size(), below);
    }
  }
  EXPECT_EQ(of_leaves, mesh.triangles.size());
  EXPECT_LT(tree.root().mesh.triangles.size(), mesh.triangles.size() / 4);
}

TEST(TileTree, ThreadsDoNotMatter) {
  const Mesh mesh = wavy_torus(40);
  const TileTree one = make_tiles(mesh, {.triangles = 300}, Context(1)),
                 more = make_tiles(mesh, {.triangles = 300}, Context(3));
  ASSERT_EQ(one.tiles.size(), more.tiles.size());
  for (size_t n = 0; n < one.tiles.size(); ++n) {
    EXPECT_EQ(one.tiles[n].mesh.vertices, more.tiles[n].mesh.vertices);
    EXPECT_EQ(one.tiles[n].mesh.triangles, more.tiles[n].mesh.triangles);
    EXPECT_EQ(one.tiles[n].error, more.tiles[n].error);
  }
}

/// Colors, attributes and normals come along; normals are those of the whole surface, also at the borders of tiles.
TEST(TileTree, VerticesKeepWhatTheyHave) {
  Mesh mesh = wavy_torus(40);
  Column height{"height", {}, false};
  for (const Vec3d& v : mesh.vertices) height.values.push_back(static_cast<float>(v.z));
  mesh.attributes.push_back(height);
  mesh.colors.assign(mesh.vertices.size(), {10, 20, 30});
  const TileTree tree = make_tiles(mesh, {.triangles = 300}, two_threads);
  std::map<std::tuple<double, double, double>, Vec3f> normal;
  for (const Tile& tile : tree.tiles) {
    ASSERT_EQ(tile.mesh.normals.size(), tile.mesh.vertices.size());
    ASSERT_EQ(tile.mesh.colors.size(), tile.mesh.vertices.size());
    ASSERT_EQ(tile.mesh.attributes.size(), 1u);
    for (size_t v = 0; v < tile.mesh.vertices.size(); ++v) {
      const Vec3d p = tile.mesh.vertices[v];
      EXPECT_NEAR(tile.mesh.attributes[0].values[v], p.z, 0.2);
      if (!tile.children.empty()) continue;
      const auto [found, is_new] = normal.try_emplace({p.x, p.y, p.z}, tile.mesh.normals[v]);
      EXPECT_EQ(found->second, tile.mesh.normals[v]) << "no seam";
    }
  }
}

TEST(TileTree, BadInputIsRefused) {
  EXPECT_THROW(make_tiles(wavy_torus(10), {.triangles = 99}, two_threads), ParameterError);
  EXPECT_THROW(make_tiles({}, {}, two_threads), ParameterError);
}

/// Two triangles that share a vertex alone, beside two that share an edge.
TEST(TilePart, FansOfOneVertexAreSplit) {
  TilePart part;
  part.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 1, 0}};
  part.mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {1, 5, 2}};
  part.whole = {10, 11, 12, 13, 14, 15};
  EXPECT_FALSE(check_topology(part.mesh).manifold());
  split_fans(part);
  EXPECT_TRUE(check_topology(part.mesh).manifold());
  ASSERT_EQ(part.mesh.vertices.size(), 7u);
  EXPECT_EQ(part.mesh.vertices[6], part.mesh.vertices[0]);
  EXPECT_EQ(part.whole[6], 10u);
  EXPECT_EQ(part.mesh.triangles[2], (Triangle{1, 5, 2}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
