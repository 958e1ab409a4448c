#include "soapfilm/relax/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "relax/grid_torus.h"
#include "soapfilm/core/random.h"
#include "support/flat_sheet.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

using Edge = std::array<uint32_t, 2>;  // the lower vertex first

/// The triangles of each edge.
std::map<Edge, std::vector<size_t>> edges_of(const Mesh& mesh) {
  std::map<Edge, std::vector<size_t>> edges;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}].push_back(t);
    }
  return edges;
}

/// The corner of a triangle that is not on an edge.
uint32_t corner_off(const Triangle& t, const Edge& edge) {
  return *std::find_if(t.begin(), t.end(), [&](uint32_t v) { return v != edge[0] && v != edge[1]; });
}

/// A torus or a sheet, its vertices disturbed, with directions near its normals.
struct Uneven {
  Mesh mesh;
  std::vector<Vec3f> normals;

  Uneven(bool open, double roughness, uint64_t seed, double turned)
      : mesh(open ? flat_sheet(14, {}, 1) : grid_torus({1, 2, 3}, 4, 1.7, 26, 11)) {
    Random random(seed);
    const auto deviate = [&] { return Vec3d{random.normal(), random.normal(), random.normal()}; };
    for (Vec3d& v : mesh.vertices) v += deviate() * roughness;
    std::vector<Vec3d> sums(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles)
      for (const uint32_t v : t)
        sums[v] += cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (const Vec3d& sum : sums) normals.push_back(Vec3f(normalized(normalized(sum) + deviate() * turned)));
  }
  double sag_of(uint32_t a, uint32_t b) const {
    return sag(mesh.vertices[a], mesh.vertices[b], normals[a], normals[b]);
  }
  double total_sag() const {
    double sum = 0;
    for (const auto& [edge, triangles] : edges_of(mesh))
      if (triangles.size() == 2) sum += sag_of(edge[0], edge[1]);
    return sum;
  }
  /// What exchanging an edge would gain, from the header; nothing where that is not allowed.
  double gain(const std::map<Edge, std::vector<size_t>>& edges, const Edge& edge) const {
    const auto& sides = edges.at(edge);
    if (sides.size() != 2) return 0;
    const uint32_t c = corner_off(mesh.triangles[sides[0]], edge), d = corner_off(mesh.triangles[sides[1]], edge);
    if (c == d || edges.count({std::min(c, d), std::max(c, d)}) != 0) return 0;
    for (const uint32_t v : {edge[0], edge[1], c, d})
      if (normals[v] == Vec3f{}) return 0;
    const auto twice = [&](const Triangle& t) {
      const auto& at = mesh.vertices;
      return cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
    };
    for (const size_t side : sides) {
      const Vec3d old = normalized(twice(mesh.triangles[side]));
      for (Triangle fresh : {mesh.triangles[sides[0]], mesh.triangles[sides[1]]}) {
        // The triangle keeps its corner off the edge and one on it; the other becomes the opposite one.
        const uint32_t own = corner_off(fresh, edge), other = own == c ? d : c;
        const uint32_t lost =
            fresh[(static_cast<size_t>(std::find(fresh.begin(), fresh.end(), own) - fresh.begin()) + 1) % 3];
        std::replace(fresh.begin(), fresh.end(), lost, other);
        if (dot(twice(fresh), old) / 2 < 0.01) return 0;
      }
    }
    return sag_of(edge[0], edge[1]) - sag_of(c, d);
  }
};

void expect_manifold(const Mesh& mesh, const Mesh& before) {
  const auto edges = edges_of(mesh), old = edges_of(before);
  ASSERT_EQ(edges.size(), old.size());
  std::map<Edge, int> directed;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) EXPECT_EQ((++directed[{t[k], t[(k + 1) % 3]}]), 1) << "turned over, or twice";
  for (const auto& [edge, triangles] : edges) {
    ASSERT_LE(triangles.size(), 2u);
    if (triangles.size() == 1) {
      ASSERT_TRUE(old.count(edge) != 0 && old.at(edge).size() == 1) << "the border stays";
    }
  }
}

class FlipEdges : public testing::TestWithParam<bool> {};

/// The whole improves by the least gain of each exchange or more.
TEST_P(FlipEdges, GainsWhatItClaimsAndStaysAManifold) {
  for (const double turned : {0.0, 0.3, 2.0})
    for (const double least_gain : {0.0, 0.01, 0.02, 0.05, 0.1, 0.2}) {
      Uneven uneven(GetParam(), 0.3, static_cast<uint64_t>(1 + 1000 * least_gain), turned);
      const Mesh before = uneven.mesh;
      const double sag_before = uneven.total_sag();
      HalfEdges edges(uneven.mesh);
      const size_t count = flip_edges(edges, uneven.normals, 1, least_gain, one_thread);
      expect_manifold(uneven.mesh, before);
      EXPECT_EQ(uneven.mesh.vertices, before.vertices);
      EXPECT_GE(sag_before - uneven.total_sag(), static_cast<double>(count) * least_gain);
      if (turned > 0) {
        EXPECT_LT(uneven.total_sag(), sag_before);
      }
      const auto old = edges_of(before), now = edges_of(uneven.mesh);
      const auto fresh = std::count_if(now.begin(), now.end(), [&](auto& edge) { return old.count(edge.first) == 0; });
      EXPECT_LE(static_cast<size_t>(fresh), count);
      const std::set<Triangle> same(before.triangles.begin(), before.triangles.end());
      const auto& at = before.vertices;
      for (const auto& [a, b, c] : uneven.mesh.triangles)
        EXPECT_TRUE(same.count({a, b, c}) != 0 || norm(cross(at[b] - at[a], at[c] - at[a])) >= 2 * 0.01);
    }
}

/// Of all exchanges the one of the largest gain is made, whatever others would be near it.
TEST_P(FlipEdges, BeginsWithTheLargestGain) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Uneven uneven(GetParam(), 0.3, seed, 1);
    const auto edges = edges_of(uneven.mesh);
    double largest = 0;
    Edge best{};
    for (const auto& [edge, sides] : edges)
      if (const double gain = uneven.gain(edges, edge); gain > largest) {
        largest = gain;
        best = edge;
      }
    ASSERT_GT(largest, 0);
    const auto& sides = edges.at(best);
    const uint32_t c = corner_off(uneven.mesh.triangles[sides[0]], best),
                   d = corner_off(uneven.mesh.triangles[sides[1]], best);
    for (const double share : {1.001, 0.999, 0.5, 0.2}) {
      Uneven copy = uneven;
      HalfEdges halves(copy.mesh);
      const size_t count = flip_edges(halves, copy.normals, 1, share * largest, one_thread);
      EXPECT_EQ(count > 0, share < 1);
      const auto now = edges_of(copy.mesh);
      EXPECT_EQ(now.count(best), share < 1 ? 0u : 1u);
      EXPECT_EQ(now.count({std::min(c, d), std::max(c, d)}), share < 1 ? 1u : 0u);
    }
  }
}

/// Two triangles in a plane; the exchange leaves one of an area of t / 2.
TEST(Flip, MakesNoTriangleOfLessThanAHundredthOfAVoxel) {
  for (const double t : {-0.1, 0.0, 0.018, 0.022, 0.3}) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {1.5 - t, -1, 0}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
    const std::vector<Vec3f> normals{{0, 0, 1}, {0.6f, 0, 0.8f}, {0, 0, 1}, {0, 0, 1}};
    HalfEdges edges(mesh);
    EXPECT_EQ(flip_edges(edges, normals, 1, 0, one_thread), t / 2 > 0.01 ? 1u : 0u) << t;
  }
}

/// Two edges of one triangle gain. After the exchange of the better one, 1-2 for 0-3, the other's half edge is one of
/// 0-3: exchanged in the same pass as well, it would bring 1-2 back, to be exchanged once more.
TEST(Flip, ChangesATriangleOncePerPass) {
  Mesh mesh;
  mesh.vertices = {{0.5, 0.8, 0}, {0, 0, 0}, {1, 0, 0}, {0.5, -0.8, 0}, {-0.5, 0.7, 0}};
  mesh.triangles = {{1, 2, 0}, {2, 1, 3}, {1, 0, 4}};
  const std::vector<Vec3f> normals{{0, 0, 1}, {-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0, 0, 1}, {0.6f, 0, 0.8f}};
  const auto gain = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const auto sag_of = [&](uint32_t p, uint32_t q) {
      return sag(mesh.vertices[p], mesh.vertices[q], normals[p], normals[q]);
    };
    return sag_of(a, b) - sag_of(c, d);
  };
  ASSERT_GT(gain(0, 1, 2, 4), 0.03);
  ASSERT_GT(gain(1, 2, 0, 3), gain(0, 1, 2, 4));
  HalfEdges edges(mesh);
  EXPECT_EQ(flip_edges(edges, normals, 1, 0, one_thread), 1u);
  const auto now = edges_of(mesh);
  EXPECT_EQ(now.count({1, 2}), 0u);
  EXPECT_EQ(now.count({0, 3}), 1u);
  EXPECT_EQ(now.count({0, 1}), 1u);
}

/// Twice as fine is half as large in everything.
TEST_P(FlipEdges, DoesNotDependOnTheUnit) {
  for (const double voxel : {1e-3, 64.0}) {
    Uneven uneven(GetParam(), 0.2, 4, 0.5);
    Mesh scaled = uneven.mesh;
    for (Vec3d& v : scaled.vertices) v = v * voxel;
    HalfEdges one(uneven.mesh), other(scaled);
    const size_t count = flip_edges(one, uneven.normals, 1, 0.01, one_thread);
    EXPECT_GT(count, 10u);
    EXPECT_EQ(flip_edges(other, uneven.normals, voxel, 0.01 * voxel, one_thread), count);
    EXPECT_EQ(scaled.triangles, uneven.mesh.triangles);
  }
}

/// Where a normal is not known, all edges stay.
TEST_P(FlipEdges, LeavesEdgesAtUnknownNormals) {
  Uneven uneven(GetParam(), 0.2, 5, 0.5);
  for (size_t v = 0; v < uneven.normals.size(); v += 7) uneven.normals[v] = {};
  const Mesh before = uneven.mesh;
  HalfEdges edges(uneven.mesh);
  EXPECT_GT(flip_edges(edges, uneven.normals, 1, 0, one_thread), 0u);
  const auto ends = [&](const Mesh& mesh) {
    std::set<Edge> found;
    for (const auto& [edge, sides] : edges_of(mesh))
      if (uneven.normals[edge[0]] == Vec3f{} || uneven.normals[edge[1]] == Vec3f{}) found.insert(edge);
    return found;
  };
  EXPECT_EQ(ends(uneven.mesh), ends(before));
}

TEST_P(FlipEdges, GivesTheSameMeshOnAnyNumberOfThreads) {
  const auto run = [&](int threads) {
    Uneven uneven(GetParam(), 0.2, 6, 0.5);
    HalfEdges edges(uneven.mesh);
    flip_edges(edges, uneven.normals, 1, 0, Context(threads));
    return uneven.mesh.triangles;
  };
  const auto expected = run(1);
  for (const int threads : {2, 5}) EXPECT_EQ(run(threads), expected);
}

INSTANTIATE_TEST_SUITE_P(ClosedAndOpen, FlipEdges, testing::Bool());

TEST(Sag, IsThatOfACircle) {
  constexpr double radius = 5;
  const auto on_circle = [&](double a) { return Vec3d{radius * std::cos(a), radius * std::sin(a), 0}; };
  for (const double a : {0.05, 0.1, 0.2}) {
    const Vec3d p = on_circle(0.3), q = on_circle(0.3 + a);
    const double exact = radius - norm((p + q) * 0.5);
    EXPECT_NEAR(sag(p, q, Vec3f(p / radius), Vec3f(q / radius)), exact, 0.01 * exact);
    EXPECT_NEAR(sag(p, q, Vec3f(p / -radius), Vec3f(q / -radius)), exact, 0.01 * exact);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
