// Laws of remesh(), judged by what knows nothing of its proofs: the topology report, exact intersections, distances of
// many points to both meshes, lengths and angles of the triangles as they are in the result.
#include "soapfilm/remesh/remesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "relax/grid_torus.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "support/farthest.h"
#include "support/flat_sheet.h"
#include "support/real_data.h"
#include "tools/mesh/distance.h"
#include "tools/mesh/self_intersection.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// A box of 12 triangles.
Mesh box(Vec3d size) {
  Mesh mesh;
  for (uint32_t i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? size.x : 0, i & 2 ? size.y : 0, i & 4 ? size.z : 0});
  for (const auto& [a, b, c, d] : std::vector<std::array<uint32_t, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

Mesh reconstructed(const std::string& name, double noise) {
  SamplingParams sampling;
  sampling.count = 30000;
  sampling.noise = noise;
  const PointCloud cloud = sample_surface(*make_shape(name), sampling, Context(2));
  ReconstructParams params;
  params.place.resolution = 90;
  return reconstruct(cloud, params, Context(2)).mesh;
}

/// Shares, of all edges and of all triangles.
struct Quality {
  double even_edges = 0, good_angles = 0;
};

Quality quality(const Mesh& mesh, double edge) {
  double even = 0, edges = 0, good = 0;
  for (const Triangle& t : mesh.triangles) {
    double least = 180;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d a = mesh.vertices[t[k]], b = mesh.vertices[t[(k + 1) % 3]], c = mesh.vertices[t[(k + 2) % 3]];
      const double length = norm(b - a) / edge;
      even += length >= 0.7 && length <= 1.4;
      ++edges;
      least = std::min(least, std::atan2(norm(cross(b - a, c - a)), dot(b - a, c - a)) * 180 / std::numbers::pi);
    }
    good += least >= 20;
  }
  return {even / edges, good / static_cast<double>(mesh.triangles.size())};
}

/// Pairs of neighbors that lie on each other within 0.3 degrees.
size_t folded_pairs(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, Vec3d> normal;  // by the edge, of the triangle that has it in this direction
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]], n = normalized(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
    for (size_t k = 0; k < 3; ++k) normal[{t[k], t[(k + 1) % 3]}] = n;
  }
  size_t count = 0;
  for (const auto& [edge, n] : normal)
    if (const auto other = normal.find({edge.second, edge.first}); other != normal.end() && edge.first < edge.second)
      count += dot(n, other->second) < -std::cos(0.3 * std::numbers::pi / 180);
  return count;
}

struct Case {
  std::string name;
  Mesh mesh;
  double edge;
};

std::vector<Case> cases() {
  return {{"sphere", make_shape("sphere")->tessellate(2e-3), 0.06},
          {"torus", make_shape("torus")->tessellate(2e-3), 0.05},
          {"knot", make_shape("knot")->tessellate(1e-3), 0.03},
          {"part with needles", make_shape("part")->tessellate(1e-3), 0.05},
          {"two sheets", make_shape("sheets")->tessellate(1e-3), 0.05},
          {"box", box({1, 2, 1.5}), 0.1},
          {"scan of a part", reconstructed("part", 0.001), 0.04},
          {"noisy scan of a torus", reconstructed("torus", 0.004), 0.04}};
}

TEST(Remesh, EvenTrianglesOfTheSameSurface) {
  const Context context(2);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Remeshed result = remesh(c.mesh, {c.edge, {}}, context);
    const TopologyReport before = check_topology(c.mesh), after = check_topology(result.mesh);
    EXPECT_TRUE(after.watertight());
    EXPECT_EQ(after.genus(), before.genus());
    EXPECT_EQ(after.components.size(), before.components.size());
    EXPECT_EQ(count_self_intersections(result.mesh, context), 0u);
    EXPECT_EQ(folded_pairs(result.mesh), 0u);
    const Quality found = quality(result.mesh, c.edge);
    EXPECT_GE(found.even_edges, 0.95);
    EXPECT_GE(found.good_angles, 0.99);
    EXPECT_NEAR(found.even_edges, result.report.even_edges, 1e-9);
    EXPECT_NEAR(found.good_angles, result.report.good_angles, 1e-9);
    EXPECT_EQ(result.report.triangles, result.mesh.triangles.size());
    EXPECT_LE(farthest_between(c.mesh, result.mesh, context), result.report.proved);
    EXPECT_LE(result.report.proved, 0.5 * c.edge);
  }
}

/// Every point of the box's edges has an edge of the result along it.
TEST(Remesh, SharpEdgesAndCornersStay) {
  const Context context(1);
  const Vec3d size{1, 2, 1.5};
  const Mesh result = remesh(box(size), {0.11, {}}, context).mesh;
  const auto on_sides = [&](Vec3d p) {
    int count = 0;
    for (int k = 0; k < 3; ++k) count += std::abs(p[k]) < 1e-5 || std::abs(p[k] - size[k]) < 1e-5;
    return count;
  };
  double along = 0;
  int corners = 0;
  for (const Vec3d& v : result.vertices) {
    EXPECT_GE(on_sides(v), 1);
    corners += on_sides(v) == 3;
  }
  EXPECT_EQ(corners, 8);
  for (const Triangle& t : result.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d a = result.vertices[t[k]], b = result.vertices[t[(k + 1) % 3]];
      if (on_sides((a + b) * 0.5) == 2) along += norm(b - a) / 2;
    }
  EXPECT_NEAR(along, 4 * (1 + 2 + 1.5), 1e-4);
  EXPECT_NEAR(result.volume(), 3, 1e-5);
}

/// A scan rounds sharp edges over a voxel; vertices go back to where the sides meet.
TEST(Remesh, EdgesThatAScanRoundedAreSharpAgain) {
  const Context context(2);
  const Mesh scan = reconstructed("part", 0), truth = make_shape("part")->tessellate(1e-4);
  const Mesh result = remesh(scan, {0.04, {}}, context).mesh;
  // Points of the long straight edges.
  std::map<std::array<uint32_t, 2>, Vec3d> normals;
  std::vector<Vec3d> points;
  for (const Triangle& t : truth.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d a = truth.vertices[t[k]], b = truth.vertices[t[(k + 1) % 3]], c = truth.vertices[t[(k + 2) % 3]];
      const Vec3d n = normalized(cross(b - a, c - a));
      const auto [other, is_new] =
          normals.insert({{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}, n});
      if (is_new || dot(other->second, n) > 0.5 || norm(b - a) < 0.2) continue;
      for (int i = 1; i < 40; ++i) points.push_back(a + (b - a) * (i / 40.0));
    }
  ASSERT_GT(points.size(), 300u);
  const auto lost = [&](const Mesh& mesh) { return summarize(distances_to_mesh(points, mesh, context)).mean; };
  EXPECT_LT(lost(result), 0.5 * lost(scan));
  EXPECT_LT(result.triangles.size(), scan.triangles.size() / 5);
}

TEST(Remesh, OpenMeshesKeepTheirBorders) {
  const Context context(1);
  Mesh sheet = flat_sheet(30, {}, 0.1);
  for (Vec3d& v : sheet.vertices) v.z = 0.3 * std::sin(2 * v.x) * std::cos(v.y);
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    const Vec3d m = (sheet.vertices[t[0]] + sheet.vertices[t[1]] + sheet.vertices[t[2]]) / 3.0;
    return norm(Vec3d{m.x - 1.5, m.y - 1.4, 0}) < 0.6;
  });
  const Remeshed result = remesh(sheet, {0.2, {}}, context);
  const TopologyReport before = check_topology(sheet), after = check_topology(result.mesh);
  EXPECT_TRUE(after.manifold());
  EXPECT_EQ(after.euler_characteristic(), before.euler_characteristic());
  EXPECT_EQ(after.closed(), before.closed());
  EXPECT_LE(farthest_between(sheet, result.mesh, context), result.report.proved);
  const auto border = [](const Mesh& mesh) {
    std::map<std::array<uint32_t, 2>, int> edges;
    for (const Triangle& t : mesh.triangles)
      for (size_t k = 0; k < 3; ++k) ++edges[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
    std::vector<std::array<Vec3d, 2>> ends;
    for (const auto& [edge, count] : edges)
      if (count == 1) ends.push_back({mesh.vertices[edge[0]], mesh.vertices[edge[1]]});
    return ends;
  };
  const auto old_border = border(sheet), new_border = border(result.mesh);
  EXPECT_LT(new_border.size(), old_border.size());
  const auto most = [](const auto& from, const auto& to) {
    double farthest = 0;
    for (const auto& edge : from)
      for (int i = 0; i <= 4; ++i) {
        const Vec3d p = edge[0] + (edge[1] - edge[0]) * (i / 4.0);
        double nearest = Box3d::infinity;
        for (const auto& e : to) {
          const Vec3d along = e[1] - e[0];
          nearest = std::min(nearest,
                             norm(p - e[0] - along * std::clamp(dot(p - e[0], along) / dot(along, along), 0.0, 1.0)));
        }
        farthest = std::max(farthest, nearest);
      }
    return farthest;
  };
  EXPECT_LE(most(old_border, new_border), result.report.proved);
  EXPECT_LE(most(new_border, old_border), result.report.proved);
  EXPECT_GE(quality(result.mesh, 0.2).good_angles, 0.98);
}

TEST(Remesh, ATightToleranceIsKeptBySmallerTriangles) {
  const Context context(2);
  const Mesh torus = make_shape("torus")->tessellate(5e-4);
  const Remeshed loose = remesh(torus, {0.1, {}}, context), tight = remesh(torus, {0.1, 0.003}, context);
  EXPECT_GT(loose.report.proved, 0.003);
  EXPECT_LE(tight.report.proved, 0.003);
  EXPECT_LE(farthest_between(torus, tight.mesh, context), 0.003);
  EXPECT_GT(tight.mesh.triangles.size(), loose.mesh.triangles.size());
  EXPECT_TRUE(check_topology(tight.mesh).watertight());
}

/// Edges longer than the tube is thick: the handles stay, by smaller triangles.
TEST(Remesh, GenusStaysWhereEdgesAreLargerThanDetails) {
  const Context context(2);
  const Mesh knot = make_shape("knot")->tessellate(2e-3);
  const Remeshed result = remesh(knot, {0.2, {}}, context);
  EXPECT_EQ(check_topology(result.mesh).genus(), 4);
  EXPECT_TRUE(check_topology(result.mesh).watertight());
  EXPECT_EQ(count_self_intersections(result.mesh, context), 0u);
  EXPECT_LE(farthest_between(knot, result.mesh, context), result.report.proved);
}

/// A ball with a horn that is thinner than the edges.
Mesh ball_with_horn() {
  Mesh mesh = make_shape("sphere")->tessellate(1e-3);
  const Vec3d center = mesh.box().center();
  const double radius = 0.5 * mesh.box().longest();
  for (Vec3d& p : mesh.vertices) {
    const Vec3d d = (p - center) / radius;
    const double high = d.z > 0 ? 1.5 * std::exp(-d.x * d.x / 0.004 - d.y * d.y / 0.02) : 0;
    p = center + d * (radius * (1 + high));
  }
  return mesh;
}

/// The law that no detail is lost, and the share of even edges that is left.
void expect_details_kept(const Mesh& given, double edge, double even_edges) {
  const Context context(2);
  const Remeshed result = remesh(given, {edge, {}}, context);
  EXPECT_LE(result.report.proved, 0.5 * edge);
  EXPECT_LE(farthest_between(given, result.mesh, context), result.report.proved);
  EXPECT_EQ(count_self_intersections(result.mesh, context), 0u);
  EXPECT_EQ(folded_pairs(result.mesh), 0u);
  const Quality found = quality(result.mesh, edge);
  EXPECT_GE(found.even_edges, even_edges);
  EXPECT_GE(found.good_angles, 0.92);
}

TEST(Remesh, ThinWallsDoNotFold) {
  const Mesh given = reconstructed("plate", 0.002);
  for (const double share : {0.05, 0.12}) {
    SCOPED_TRACE(share);
    expect_details_kept(given, share * given.box().longest(), 0.9);
  }
}

TEST(Remesh, AHornThinnerThanTheEdgesIsNotLost) {
  const Mesh given = ball_with_horn();
  for (const double share : {0.1, 0.13, 0.16}) {
    SCOPED_TRACE(share);
    expect_details_kept(given, share * given.box().longest(), 0.9);
  }
}

TEST(Remesh, LegsAndEarsThinnerThanTheEdgesAreNotLost) {
  for (const auto& [name, even_edges] : std::vector<std::pair<std::string, double>>{
           {"horse.ply", 0.7}, {"bunny_hr.obj", 0.95}, {"dancing_children.off", 0.85}}) {
    const auto file = real_data("meshes/" + name);
    if (!file) GTEST_SKIP() << "SOAPFILM_DATA does not name a folder with meshes";
    SCOPED_TRACE(name);
    const Mesh given = read_mesh(*file);
    expect_details_kept(given, 0.1 * given.box().longest(), even_edges);
  }
}

TEST(Remesh, TheSameForAnyNumberOfThreads) {
  const Mesh torus = grid_torus({}, 5, 2, 200, 100);
  const Remeshed one = remesh(torus, {0.3, {}}, Context(1));
  for (const int threads : {2, 4}) {
    const Remeshed many = remesh(torus, {0.3, {}}, Context(threads));
    EXPECT_EQ(many.mesh.vertices, one.mesh.vertices);
    EXPECT_EQ(many.mesh.triangles, one.mesh.triangles);
    EXPECT_EQ(many.report.proved, one.report.proved);
  }
}

TEST(Remesh, AttributesComeAlong) {
  Mesh mesh = grid_torus({}, 5, 2, 120, 60);
  mesh.attributes = {{"x", {}}, {"side", {}, true}};
  for (const Vec3d& v : mesh.vertices) {
    mesh.attributes[0].values.push_back(static_cast<float>(v.x));
    mesh.attributes[1].values.push_back(v.x > 0 ? 7 : 3);
    mesh.colors.push_back({static_cast<uint8_t>(100 + 10 * v.x), 20, 30});
  }
  const Mesh result = remesh(mesh, {0.4, {}}, Context(1)).mesh;
  ASSERT_EQ(result.colors.size(), result.vertices.size());
  for (size_t v = 0; v < result.vertices.size(); ++v) {
    EXPECT_NEAR(result.attributes[0].values[v], result.vertices[v].x, 0.05);
    EXPECT_TRUE(result.attributes[1].values[v] == 7 || result.attributes[1].values[v] == 3);
    EXPECT_NEAR(result.colors[v][0], 100 + 10 * result.vertices[v].x, 2);
  }
}

TEST(Remesh, FarFromTheOriginAndWithVerticesThatNothingUses) {
  const Context context(1);
  Mesh torus = grid_torus({}, 5, 2, 60, 30);
  for (Vec3d& v : torus.vertices) v += Vec3d{4512345.25, 5400000.5, 312.125};
  torus.vertices.push_back({4512345, 5400000, 312});
  const Remeshed result = remesh(torus, {0.8, {}}, context);
  EXPECT_TRUE(check_topology(result.mesh).watertight());
  EXPECT_GE(quality(result.mesh, 0.8).even_edges, 0.95);
  torus.vertices.pop_back();
  EXPECT_LE(farthest_between(torus, result.mesh, context), result.report.proved);
}

TEST(Remesh, RefusesWhatItCannotDo) {
  const auto message = [](const Mesh& mesh, const RemeshParams& params) -> std::string {
    try {
      remesh(mesh, params, Context(1));
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "nothing refused";
  };
  Mesh fan = flat_sheet(2, {}, 1);
  EXPECT_EQ(message(fan, {0, {}}), "edge = 0, must be > 0");
  EXPECT_EQ(message(fan, {std::nan(""), {}}), "edge = nan, must be > 0");
  EXPECT_EQ(message(fan, {1, -1}), "tolerance = -1, must be > 0");
  EXPECT_NE(message(fan, {1e-6, {}}).find("edge = 1e-06: about 9.2e+12 triangles, must be at most"), std::string::npos);
  EXPECT_EQ(message({}, {1, {}}), "mesh: it has no area, must have triangles");
  fan.vertices.push_back({0, 0, 1});
  fan.triangles.push_back({0, 4, 9});
  EXPECT_EQ(message(fan, {1, {}}), "mesh: edge 0-4 is in 3 triangles, must be a 2-manifold");
}

TEST(Remesh, StopsWhenCancelled) {
  Progress progress;
  progress.cancel();
  EXPECT_THROW(remesh(grid_torus({}, 5, 2, 60, 30), {0.3, {}}, Context(1, progress)), Cancelled);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
