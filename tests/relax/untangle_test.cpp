#include "soapfilm/relax/untangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "refine/band_support.h"
#include "soapfilm/relax/crossings.h"
#include "soapfilm/relax/half_edges.h"
#include "support/hash.h"
#include "support/sanitized.h"
#include "tools/mesh/self_intersection.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr int resolution = 40;
constexpr int few = sanitized ? 32 : resolution;  // where the shape does not matter
constexpr double swelling = 2;                    // voxels

struct Drawn {
  Mesh mesh;
  double voxel;
};

/// As marching cubes draws it.
Drawn drawn(const std::string& shape, int at = resolution) {
  const Solved solved(shape, at, 2);
  return {refined(solved).mesh, solved.problem.lattice.voxel};
}

/// One vertex in `every` moves by normal deviates.
std::vector<Vec3d> disturbed(const Drawn& d, double deviation, int every, uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> places = d.mesh.vertices;
  for (Vec3d& p : places)
    if (random.next() % static_cast<uint64_t>(every) == 0)
      p += Vec3d{random.normal(), random.normal(), random.normal()} * (deviation * d.voxel);
  return places;
}

std::vector<CrossingSearch::Pair> crossings(const Drawn& d, const std::vector<Vec3d>& places, int threads = 1) {
  const std::vector<uint8_t> all(d.mesh.triangles.size(), 1);
  const Context context(threads);
  const CrossingSearch search({d.mesh.triangles, d.mesh.triangles, d.mesh.vertices, places, all}, d.voxel, context);
  return search.find(places, all);
}

TEST(Crossings, AreThePairsThatTheCheckCounts) {
  const Drawn d = drawn("knot", few);
  for (const int every : {1, 20, 200})
    for (const double deviation : {0.03, 0.2, 1.0}) {
      Mesh mesh = d.mesh;
      mesh.vertices = disturbed(d, deviation, every, 1);
      auto pairs = crossings(d, mesh.vertices);
      for (const auto& [a, b] : pairs) EXPECT_LT(a, b);
      std::sort(pairs.begin(), pairs.end());
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
      EXPECT_EQ(pairs.size(), count_self_intersections(mesh, Context(1))) << every << " " << deviation;
    }
}

/// Each vertex has come as far as it likes.
TEST(Crossings, AreThosePairsOnTheWayToo) {
  const Drawn d = drawn("knot", few);
  const std::vector<uint8_t> all(d.mesh.triangles.size(), 1);
  const Context context(1);
  Random random(9);
  for (const int every : {1, 20, 200})
    for (const double deviation : {0.1, 0.5, 2.0}) {
      const auto target = disturbed(d, deviation, every, 5);
      const CrossingSearch search({d.mesh.triangles, d.mesh.triangles, d.mesh.vertices, target, all}, d.voxel, context);
      Mesh mesh = d.mesh;
      for (size_t v = 0; v < target.size(); ++v) {
        constexpr std::array<double, 4> come = {0, 0.25, 0.5, 1};
        mesh.vertices[v] += (target[v] - mesh.vertices[v]) * come[random.next() % come.size()];
      }
      auto pairs = search.find(mesh.vertices, all);
      std::sort(pairs.begin(), pairs.end());
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
      EXPECT_EQ(pairs.size(), count_self_intersections(mesh, context)) << every << " " << deviation;
    }
}

TEST(Crossings, AreTheSameOnAnyNumberOfThreads) {
  const Drawn d = drawn("torus");
  const auto places = disturbed(d, 0.5, 3, 2);
  const auto one = crossings(d, places);
  EXPECT_FALSE(one.empty());
  for (const int threads : {2, 3, 8}) EXPECT_EQ(crossings(d, places, threads), one) << threads;
}

TEST(Crossings, OnlyOfTrianglesThatChanged) {
  const Drawn d = drawn("torus");
  const auto places = disturbed(d, 0.5, 3, 2);
  const std::vector<uint8_t> all(d.mesh.triangles.size(), 1);
  std::vector<uint8_t> some(all.size());
  for (size_t t = 0; t < some.size(); t += 7) some[t] = 1;
  const Context context(1);
  const CrossingSearch search({d.mesh.triangles, d.mesh.triangles, d.mesh.vertices, places, all}, d.voxel, context);
  auto expected = search.find(places, all);
  std::erase_if(expected, [&](const auto& pair) { return !some[pair[0]] && !some[pair[1]]; });
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(search.find(places, some), expected);
}

TEST(TakeBack, LeavesNothingThatMeetsAndFewMovesUndone) {
  const Drawn d = drawn("knot");
  for (const auto& [deviation, every] : {std::pair{0.05, 1}, {0.3, 1}, {2.0, 30}}) {
    Mesh mesh = d.mesh;
    mesh.vertices = disturbed(d, deviation, every, 3);
    const std::vector<Vec3d> target = mesh.vertices;
    const size_t before = count_self_intersections(mesh, Context(1));
    EXPECT_GT(before, 0u);
    untangle(mesh, d.mesh.vertices, d.voxel, Context(1));
    EXPECT_EQ(count_self_intersections(mesh, Context(1)), 0u) << deviation;
    size_t undone = 0;
    for (size_t v = 0; v < target.size(); ++v) undone += !(mesh.vertices[v] == target[v]);
    EXPECT_GT(undone, 0u);
    if (deviation < 0.1) {
      EXPECT_LT(undone, target.size() / 4);
    }
    for (const int threads : {2, 8}) {
      Mesh again = d.mesh;
      again.vertices = target;
      untangle(again, d.mesh.vertices, d.voxel, Context(threads));
      EXPECT_EQ(hash_mesh(again), hash_mesh(mesh)) << threads;
    }
  }
}

// Tubes that swell until they run through each other: no triangle turns far.
TEST(TakeBack, LetsPartsGrowUntilTheyMeet) {
  const Drawn d = drawn("knot");
  Mesh mesh = d.mesh;
  std::vector<Vec3d> normals(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t v : t)
      normals[v] += cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
  for (size_t v = 0; v < normals.size(); ++v) mesh.vertices[v] += normalized(normals[v]) * (swelling * d.voxel);
  const std::vector<Vec3d> target = mesh.vertices;
  EXPECT_GT(count_self_intersections(mesh, Context(1)), 100u);
  untangle(mesh, d.mesh.vertices, d.voxel, Context(1));
  EXPECT_EQ(count_self_intersections(mesh, Context(1)), 0u);
  size_t undone = 0;
  for (size_t v = 0; v < target.size(); ++v) undone += !(mesh.vertices[v] == target[v]);
  EXPECT_GT(undone, 0u);
  EXPECT_LT(undone, target.size() / 2);
}

TEST(TakeBack, LeavesMovesThatHarmNothing) {
  const Drawn d = drawn("torus");
  Mesh mesh = d.mesh;
  for (Vec3d& p : mesh.vertices) p += Vec3d{0.3, -0.2, 0.1} * d.voxel;
  const std::vector<Vec3d> target = mesh.vertices;
  untangle(mesh, d.mesh.vertices, d.voxel, Context(1));
  EXPECT_EQ(mesh.vertices, target);
}

TEST(HalfEdges, TwinsRunBackAndForth) {
  Mesh mesh = drawn("torus").mesh;
  const HalfEdges edges(mesh);
  for (uint32_t h = 0; h < edges.size(); ++h) {
    ASSERT_EQ(edges.twin(edges.twin(h)), h);
    ASSERT_EQ(edges.from(edges.twin(h)), edges.to(h));
    ASSERT_EQ(edges.to(edges.twin(h)), edges.from(h));
    ASSERT_TRUE(edges.joins(h, edges.to(h)));
    ASSERT_TRUE(edges.joins(h, edges.opposite(h)));
    ASSERT_FALSE(edges.joins(h, edges.from(h)));
  }
}

TEST(HalfEdges, StayTwinsWhenDiagonalsChange) {
  Mesh mesh = drawn("torus").mesh;
  HalfEdges edges(mesh);
  Random random(4);
  size_t flips = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto h = static_cast<uint32_t>(random.next() % edges.size());
    const uint32_t c = edges.opposite(h), d = edges.opposite(edges.twin(h));
    if (c == d || edges.joins(HalfEdges::previous(h), d)) continue;
    edges.flip(h);
    ++flips;
  }
  EXPECT_GT(flips, 1000u);
  const HalfEdges fresh(mesh);
  for (uint32_t h = 0; h < edges.size(); ++h) ASSERT_EQ(edges.twin(h), fresh.twin(h));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
