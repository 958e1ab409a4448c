// Laws of simplify(), judged by what knows nothing of its proofs: the topology report, exact intersections, distances
// of many points to both meshes.
#include "soapfilm/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "relax/grid_torus.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/simplify/engine.h"
#include "support/farthest.h"
#include "support/flat_sheet.h"
#include "tools/mesh/distance.h"
#include "tools/mesh/self_intersection.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Appends a mesh.
void join(Mesh& to, const Mesh& other) {
  const auto first = static_cast<uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

template <class Move>
Mesh moved(Mesh mesh, Move&& move) {
  for (Vec3d& v : mesh.vertices) v = move(v);
  return mesh;
}

Mesh rough(Mesh mesh, double size, uint64_t seed) {
  Random random(seed);
  return moved(std::move(mesh), [&](Vec3d v) {
    const auto shift = [&] { return size * (2 * random.uniform() - 1); };
    return v + Vec3d{shift(), shift(), shift()};
  });
}

/// The surface of a box, n x n squares a side, its edges sharp.
Mesh cube(uint32_t n, Vec3d center, double half) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Mesh sheet = moved(flat_sheet(n, {-half, -half, side * half}, 2 * half / n),
                               [&](Vec3d v) { return center + permuted(v, axis); });
      join(mesh, sheet);
      if (side < 0)
        for (size_t t = mesh.triangles.size() - sheet.triangles.size(); t < mesh.triangles.size(); ++t)
          std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
  std::vector<uint32_t> same(mesh.vertices.size());
  std::vector<Vec3d> places;
  for (size_t v = 0; v < same.size(); ++v) {
    const auto near =
        std::find_if(places.begin(), places.end(), [&](Vec3d p) { return norm(p - mesh.vertices[v]) < 1e-9; });
    same[v] = static_cast<uint32_t>(near - places.begin());
    if (near == places.end()) places.push_back(mesh.vertices[v]);
  }
  mesh.vertices = places;
  for (Triangle& t : mesh.triangles) t = {same[t[0]], same[t[1]], same[t[2]]};
  return mesh;
}

Mesh inside_out(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::vector<std::vector<Vec3d>> borders(const Mesh& mesh) {
  std::set<std::pair<uint32_t, uint32_t>> halves;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) halves.insert({t[k], t[(k + 1) % 3]});
  std::vector<std::vector<Vec3d>> edges;
  for (const auto& [a, b] : halves)
    if (!halves.contains({b, a})) edges.push_back({mesh.vertices[a], mesh.vertices[b]});
  return edges;
}

double border_distance(const Mesh& a, const Mesh& b) {
  const auto one_sided = [](const Mesh& from, const Mesh& to) {
    double farthest = 0;
    const auto edges = borders(to);
    for (const auto& edge : borders(from))
      for (int i = 0; i <= 8; ++i) {
        const Vec3d p = edge[0] + (edge[1] - edge[0]) * (i / 8.0);
        double nearest = Box3d::infinity;
        for (const auto& e : edges) {
          const Vec3d along = e[1] - e[0];
          const double s = std::clamp(dot(p - e[0], along) / dot(along, along), 0.0, 1.0);
          nearest = std::min(nearest, norm(p - e[0] - along * s));
        }
        farthest = std::max(farthest, nearest);
      }
    return farthest;
  };
  return std::max(one_sided(a, b), one_sided(b, a));
}

struct Case {
  std::string name;
  Mesh mesh;
  double tolerance;
};

std::vector<Case> cases() {
  const Mesh torus = grid_torus({}, 5, 2, 60, 30);
  std::vector<Case> all;
  all.push_back({"torus", torus, 0.05});
  all.push_back({"rough torus", rough(torus, 0.05, 1), 0.08});
  all.push_back({"rough torus, coarse", rough(torus, 0.05, 2), 0.5});
  all.push_back({"tolerance beyond the tube", torus, 3});
  all.push_back({"needles", moved(torus, [](Vec3d v) { return Vec3d{v.x * 1000, v.y, v.z}; }), 0.2});
  all.push_back({"flattened", moved(torus, [](Vec3d v) { return Vec3d{v.x, v.y, v.z * 1e-3}; }), 0.01});
  all.push_back({"sharp cube", cube(24, {}, 1), 0.01});
  Mesh shell = cube(16, {}, 1);
  join(shell, inside_out(cube(20, {}, 0.98)));
  all.push_back({"wall thinner than the tolerance", shell, 0.1});
  Mesh near = torus;
  join(near, moved(torus, [](Vec3d v) { return Vec3d{v.x, v.z, v.y} + Vec3d{5, 0, 0}; }));
  all.push_back({"linked tori", near, 0.3});
  Mesh crumbs = torus;
  for (int i = 0; i < 20; ++i) join(crumbs, cube(1, Vec3d{i * 0.1 - 1, 0, 0}, 0.03));
  all.push_back({"crumbs", crumbs, 0.2});
  Mesh touching = cube(8, {}, 1);
  join(touching, cube(8, {2, 2, 2}, 1));  // one place in common, each with a vertex of its own
  all.push_back({"same place twice", touching, 0.05});
  all.push_back({"flat sheet", flat_sheet(30, {}, 0.1), 0.01});
  all.push_back({"bumpy sheet",
                 moved(flat_sheet(40, {}, 0.1),
                       [](Vec3d v) {
                         return Vec3d{v.x, v.y, 0.3 * std::sin(3 * v.x) * std::cos(2 * v.y)};
                       }),
                 0.02});
  Mesh holes = flat_sheet(30, {}, 0.1);
  std::erase_if(holes.triangles, [&](const Triangle& t) {
    const Vec3d m = (holes.vertices[t[0]] + holes.vertices[t[1]] + holes.vertices[t[2]]) / 3.0;
    return norm(m - Vec3d{1, 1, 0}) < 0.5 || norm(m - Vec3d{2.2, 2, 0}) < 0.3;
  });
  all.push_back({"sheet with holes", rough(holes, 0.01, 3), 0.05});
  all.push_back({"far from the origin",
                 moved(torus,
                       [](Vec3d v) {
                         return v + Vec3d{4512345.25, 5400000.5, 312.125};
                       }),
                 0.05});
  return all;
}

/// As far as a float may be from it.
Mesh as_floats(Mesh mesh) {
  return moved(std::move(mesh), [](Vec3d v) { return Vec3d(Vec3f(v)); });
}

TEST(Simplify, KeepsDistanceTopologyAndBordersWithoutIntersections) {
  const Context context(2);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Simplified result = simplify(c.mesh, c.tolerance, context);
    const TopologyReport before = check_topology(c.mesh), after = check_topology(result.mesh);
    EXPECT_TRUE(after.manifold());
    EXPECT_EQ(after.components.size(), before.components.size());
    EXPECT_EQ(after.euler_characteristic(), before.euler_characteristic());
    EXPECT_EQ(after.closed(), before.closed());
    EXPECT_EQ(after.zero_area_triangles, 0u);
    EXPECT_EQ(count_self_intersections(result.mesh, context), 0u);
    EXPECT_LE(farthest_between(c.mesh, result.mesh, context), c.tolerance);
    EXPECT_LE(result.report.proved, c.tolerance);
    EXPECT_LE(border_distance(c.mesh, result.mesh), c.tolerance);
    EXPECT_EQ(result.report.triangles, result.mesh.triangles.size());
    EXPECT_LT(result.mesh.triangles.size(), c.mesh.triangles.size());
  }
}

/// Nothing but the link condition, its border and its tetrahedra included, is left to keep the surface from being
/// pinched: no distance is in its way.
TEST(Simplify, LinkConditionAloneKeepsTheTopology) {
  const Context context(2);
  std::vector<Case> all;
  all.push_back({"torus", grid_torus({}, 5, 2, 40, 20), 4});
  all.push_back({"thin torus", grid_torus({}, 5, 0.5, 60, 8), 8});
  Mesh ribbon = flat_sheet(30, {}, 0.1);
  std::erase_if(ribbon.triangles, [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&](uint32_t v) { return ribbon.vertices[v].y > 0.25; });
  });
  all.push_back({"ribbon", ribbon, 1});
  Mesh ring = moved(ribbon, [](Vec3d v) { return Vec3d{v.x, v.y, 0.2 * std::sin(4 * v.x)}; });
  all.push_back({"wavy ribbon", ring, 1});
  const Mesh tetrahedron{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.9, 0.9, 0.01}}, {{0, 1, 3}, {0, 3, 2}, {0, 2, 1}, {1, 2, 3}}, {}, {}, {}};
  all.push_back({"flat tetrahedron", tetrahedron, 1});
  for (const Case& c : all) {
    SCOPED_TRACE(c.name);
    const Mesh small = simplify_checked(c.mesh, c.tolerance, {false, false}, context).mesh;
    const TopologyReport before = check_topology(c.mesh), after = check_topology(small);
    EXPECT_TRUE(after.manifold());
    EXPECT_EQ(after.components.size(), before.components.size());
    EXPECT_EQ(after.euler_characteristic(), before.euler_characteristic());
    EXPECT_EQ(after.closed(), before.closed());
  }
}

TEST(Simplify, LeavesFewTrianglesAndTheVolume) {
  const Context context(1);
  const Mesh torus = grid_torus({}, 5, 2, 240, 120);  // edges of about 0.12
  const Simplified smooth = simplify(torus, 0.006, context);
  EXPECT_LT(smooth.mesh.triangles.size(), torus.triangles.size() / 6);
  EXPECT_NEAR(smooth.mesh.volume() / torus.volume(), 1, 1e-6);
  const Mesh box = cube(40, {}, 1);
  EXPECT_LT(simplify(box, 0.002, context).mesh.triangles.size(), 60u);
  EXPECT_LT(simplify(flat_sheet(40, {}, 0.1), 0.002, context).mesh.triangles.size(), 40u);
}

TEST(Simplify, TheSameForAnyNumberOfThreads) {
  const Mesh mesh = rough(grid_torus({}, 30, 12, 300, 150), 0.05, 4);
  const Simplified one = simplify(mesh, 0.1, Context(1));
  for (const int threads : {2, 3}) {
    const Simplified many = simplify(mesh, 0.1, Context(threads));
    EXPECT_EQ(many.mesh.vertices, one.mesh.vertices);
    EXPECT_EQ(many.mesh.triangles, one.mesh.triangles);
  }
}

TEST(Simplify, CoordinatesAreFloatsWhereFloatsWillDo) {
  const Simplified near = simplify(rough(grid_torus({}, 5, 2, 60, 30), 0.05, 5), 0.1, Context(1));
  EXPECT_EQ(near.mesh.vertices, as_floats(near.mesh).vertices);
  const Mesh far = moved(grid_torus({}, 5, 2, 60, 30), [](Vec3d v) { return v + Vec3d{4512345.25, 5400000.5, 0}; });
  const Simplified result = simplify(far, 0.1, Context(1));
  EXPECT_LE(farthest_between(far, result.mesh, Context(1)), 0.1);
}

TEST(Simplify, ReachesANumberOfTriangles) {
  const Context context(2);
  const Mesh torus = rough(grid_torus({}, 5, 2, 120, 60), 0.01, 6);
  double last = 0;
  for (const size_t wanted : {6000, 2000, 500}) {
    const Simplified result = simplify_to(torus, wanted, context);
    EXPECT_LE(result.mesh.triangles.size(), wanted);
    EXPECT_GE(result.mesh.triangles.size(), wanted * 7 / 10);
    EXPECT_GT(result.report.tolerance, last);
    EXPECT_LE(farthest_between(torus, result.mesh, context), result.report.proved);
    EXPECT_EQ(count_self_intersections(result.mesh, context), 0u);
    last = result.report.tolerance;
  }
  EXPECT_EQ(check_topology(simplify_to(torus, 1, context).mesh).genus(), 1);
}

TEST(Simplify, AttributesComeAlong) {
  Mesh mesh = grid_torus({}, 5, 2, 120, 60);
  mesh.attributes = {{"x", {}}, {"side", {}, true}};
  for (const Vec3d& v : mesh.vertices) {
    mesh.attributes[0].values.push_back(static_cast<float>(v.x));
    mesh.attributes[1].values.push_back(v.x > 0 ? 7 : 3);
    mesh.normals.push_back(Vec3f(normalized(v - normalized(Vec3d{v.x, v.y, 0}) * 5.0)));
    mesh.colors.push_back({static_cast<uint8_t>(100 + 10 * v.x), 20, 30});
  }
  const Mesh small = simplify(mesh, 0.02, Context(1)).mesh;
  ASSERT_EQ(small.colors.size(), small.vertices.size());
  for (size_t v = 0; v < small.vertices.size(); ++v) {
    const Vec3d p = small.vertices[v];
    EXPECT_NEAR(small.attributes[0].values[v], p.x, 0.05);
    EXPECT_TRUE(small.attributes[1].values[v] == 7 || small.attributes[1].values[v] == 3);
    if (std::abs(p.x) > 0.5) {
      EXPECT_EQ(small.attributes[1].values[v], p.x > 0 ? 7 : 3);
    }
    EXPECT_NEAR(small.colors[v][0], 100 + 10 * p.x, 2);
    EXPECT_GT(dot(Vec3d(small.normals[v]), normalized(p - normalized(Vec3d{p.x, p.y, 0}) * 5.0)), 0.99);
  }
}

TEST(Simplify, RefusesWhatIsNoManifold) {
  const auto message = [](const Mesh& mesh, double tolerance) -> std::string {
    try {
      simplify(mesh, tolerance, Context(1));
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "nothing refused";
  };
  Mesh fan = flat_sheet(2, {}, 1);
  fan.vertices.push_back({0, 0, 1});
  fan.triangles.push_back({0, 4, 9});
  EXPECT_EQ(message(fan, 0.1), "mesh: edge 0-4 is in 3 triangles, must be a 2-manifold");
  Mesh turned = flat_sheet(2, {}, 1);
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_NE(message(turned, 0.1).find("opposite orientation"), std::string::npos);
  Mesh bow{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}, {}, {}, {}};
  EXPECT_EQ(message(bow, 0.1), "mesh: the triangles at vertex 0 are more than one fan, must be a 2-manifold");
  EXPECT_EQ(message(flat_sheet(2, {}, 1), -1), "tolerance = -1, must be > 0");
}

TEST(Simplify, StopsWhenCancelled) {
  Progress progress;
  progress.cancel();
  EXPECT_THROW(simplify(grid_torus({}, 5, 2, 60, 30), 0.1, Context(1, progress)), Cancelled);
}

/// What judges here must see the faults that each check prevents.
TEST(SimplifyChecks, EachOfThemIsNeeded) {
  const Context context(1);
  const Mesh torus = rough(grid_torus({}, 5, 2, 100, 50), 0.03, 7);
  bool too_far = false;
  for (const double tolerance : {0.03, 0.05, 0.08})
    too_far |=
        farthest_between(torus, simplify_checked(torus, tolerance, {false, true}, context).mesh, context) > tolerance;
  EXPECT_TRUE(too_far);
  Mesh shell = grid_torus({}, 5, 2, 90, 40);
  join(shell, inside_out(grid_torus({}, 5, 1.95, 83, 37)));
  ASSERT_EQ(count_self_intersections(shell, context), 0u);
  EXPECT_GT(count_self_intersections(simplify_checked(shell, 0.2, {true, false}, context).mesh, context), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
