#include "soapfilm/relax/relax.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "refine/band_support.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/relax/flip.h"
#include "support/hash.h"
#include "support/sanitized.h"
#include "tools/mesh/self_intersection.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr double scale = 0.1;

Mesh bent(const Solved& solved, const Refined& refined, const RelaxParams& params = {}, int threads = 1,
          RelaxReport* report = nullptr) {
  const Context context(threads);
  Mesh mesh = refined.mesh;
  const RelaxReport found = relax_mesh(mesh, SmoothField(refined.field.grid, refined.field.value, context),
                                       solved.problem.samples, scale, solved.problem.lattice, params, context);
  if (report) *report = found;
  return mesh;
}

void expect_same_topology(const Mesh& mesh, const Mesh& before) {
  const TopologyReport a = check_topology(mesh), b = check_topology(before);
  EXPECT_TRUE(a.watertight());
  EXPECT_EQ(a.components.size(), b.components.size());
  EXPECT_EQ(a.genus(), b.genus());
}

TEST(Bend, FollowsDetailThatTrianglesOfAVoxelLoseSlow) {
  for (const char* shape : {"knot", "plate", "part"}) {
    const Solved solved(shape, 70);
    const Refined flat = refined(solved);
    RelaxReport report;
    const Mesh mesh = bent(solved, flat, {}, 1, &report);
    EXPECT_LT(mean_error_vox(solved, mesh), 0.85 * mean_error_vox(solved, flat.mesh)) << shape;
    expect_same_topology(mesh, flat.mesh);
    EXPECT_LT(mesh.triangles.size(), 2.0 * static_cast<double>(flat.mesh.triangles.size())) << shape;
    EXPECT_EQ(report.triangles_before, flat.mesh.triangles.size());
    EXPECT_EQ(mesh.vertices.size(), flat.mesh.vertices.size() + report.split_edges);
    EXPECT_EQ(mesh.triangles.size(), flat.mesh.triangles.size() + 2 * report.split_edges);
    EXPECT_EQ(count_self_intersections(mesh, Context(1)), 0u) << shape;
  }
}

/// A part of the surface, as of an open box: its border stays where it is, but for the vertices' moves.
TEST(Bend, KeepsTheBorderOfAnOpenMesh) {
  const Solved solved("torus", 40);
  Refined part = refined(solved);
  const Vec3i n = solved.problem.lattice.box(0).free_hi;
  const VertexRange range{{n.x / 3, 0, 0}, {n.x, n.y, n.z / 2}};
  part.mesh = extract_isosurface(
      part.field.grid, part.field.value, [&](Vec3i brick) { return part.field.missing_value(brick); }, 0,
      solved.problem.lattice, Context(1), range);
  const TopologyReport before = check_topology(part.mesh);
  ASSERT_FALSE(before.closed());
  RelaxReport report;
  const Mesh mesh = bent(solved, part, {}, 1, &report);
  const TopologyReport after = check_topology(mesh);
  EXPECT_GT(report.split_edges, 0u);
  EXPECT_TRUE(after.manifold());
  EXPECT_EQ(after.boundary_edges, before.boundary_edges);
  EXPECT_EQ(after.components.size(), before.components.size());
  EXPECT_EQ(count_self_intersections(mesh, Context(1)), 0u);
  for (const int threads : {2, 3}) EXPECT_EQ(hash_mesh(bent(solved, part, {}, threads)), hash_mesh(mesh));
}

TEST(Bend, IsTheSameOnAnyNumberOfThreads) {
  const Solved solved("torus", 30);
  const Refined flat = refined(solved);
  const Mesh one = bent(solved, flat);
  EXPECT_GT(one.triangles.size(), flat.mesh.triangles.size());
  for (const int threads : {2, 3, 8}) EXPECT_EQ(hash_mesh(bent(solved, flat, {}, threads)), hash_mesh(one)) << threads;
}

TEST(Bend, ASmallerToleranceSplitsMoreAndZeroNothing) {
  const Solved solved("torus", 30);
  const Refined flat = refined(solved);
  const auto triangles = [&](double tolerance) { return bent(solved, flat, {tolerance}).triangles.size(); };
  EXPECT_GT(triangles(0.005), triangles(0.02));
  EXPECT_GT(triangles(0.02), triangles(1));
  EXPECT_EQ(triangles(1), flat.mesh.triangles.size());
  EXPECT_EQ(hash_mesh(bent(solved, flat, {0})), hash_mesh(flat.mesh));
}

TEST(Bend, OutliersPullNothing) {
  const Solved solved("torus", 40, 2, {.viewing = false, .outliers = 0.1});
  const Refined flat = refined(solved);
  const Mesh mesh = bent(solved, flat);
  EXPECT_LT(mean_error_vox(solved, mesh), mean_error_vox(solved, flat.mesh));
  expect_same_topology(mesh, flat.mesh);
}

TEST(Bend, NoiseIsNotFollowed) {  // it was: errors two to three times as large
  for (const double noise : {0.03, 0.08}) {
    const Solved solved("torus", 40, 2, {.noise_vox = noise});
    const Refined flat = refined(solved);
    EXPECT_LT(mean_error_vox(solved, bent(solved, flat)), mean_error_vox(solved, flat.mesh)) << noise;
  }
}

/// The faces of a cube, with noise of a twentieth of a voxel: what is missed at its edges says nothing of its faces.
TEST(Bend, NoiseOfFlatPlacesIsNotFollowedBesideSharpEdges) {
  Random random(1);
  PointCloud cloud;
  for (int i = 0; i < 30000; ++i) {
    const int axis = i % 3;
    const double side = i % 2 ? 1 : -1;
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = 2 * random.uniform() - 1;
    p[axis] = side * (1 + 0.0015 * random.normal());
    Vec3f outward;
    outward[axis] = static_cast<float>(side);
    cloud.positions.push_back(p);
    cloud.normals.push_back(outward);
  }
  ReconstructParams params;
  params.place.resolution = 64;
  const Reconstruction result = reconstruct(cloud, params, Context(2));
  EXPECT_GT(result.report.relax->split_edges, 100u);
  double sum = 0, areas = 0;
  for (const Triangle& t : result.mesh.triangles) {
    const Vec3d a = result.mesh.vertices[t[0]], b = result.mesh.vertices[t[1]], c = result.mesh.vertices[t[2]];
    std::array<double, 3> place;
    for (int k = 0; k < 3; ++k) place[static_cast<size_t>(k)] = std::abs(a[k] + b[k] + c[k]) / 3;
    std::sort(place.begin(), place.end());
    if (place[1] > 0.8) continue;  // near an edge
    const Vec3d n = cross(b - a, c - a);
    sum += norm(n) * std::acos(std::min(1.0, std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) / norm(n)));
    areas += norm(n);
  }
  EXPECT_LT(sum / areas * 180 / std::numbers::pi, 0.9);  // 1.1 where one share served the whole surface
}

// Without a search for them 27, 68 and 40 pairs meet.
TEST(Bend, LeavesNoTrianglesThatMeetSlow) {
  const Disturbance normals{.viewing = false}, outliers{.viewing = false, .outliers = 0.1};
  for (const auto& [shape, disturbance] : {std::pair{"part", normals}, {"part", outliers}, {"plate", outliers}}) {
    const Solved solved(shape, 90, 1, disturbance);
    const Refined flat = refined(solved);
    ASSERT_EQ(count_self_intersections(flat.mesh, Context(1)), 0u);
    const Mesh mesh = bent(solved, flat);
    EXPECT_EQ(count_self_intersections(mesh, Context(1)), 0u) << shape;
    expect_same_topology(mesh, flat.mesh);
  }
}

TEST(Bend, NoFieldRunsAMeshThroughItself) {
  const Solved solved("knot", sanitized ? 32 : 40, 2);
  const Refined flat = refined(solved);
  const Context context(1);
  for (const double roughness : {0.1, 0.3, 1.0}) {
    Field<float> value(flat.field.grid);
    Random random(7);
    for (size_t b = 0; b < flat.field.grid.size(); ++b)
      for (int i = 0; i < brick_volume; ++i)
        value.brick(b)[i] = flat.field.value.brick(b)[i] + static_cast<float>(roughness * random.normal());
    const SmoothField field(flat.field.grid, value, context);
    uint64_t hash = 0;
    for (const int threads : {1, 3}) {
      Mesh mesh = flat.mesh;
      const RelaxReport report =
          relax_mesh(mesh, field, solved.problem.samples, scale, solved.problem.lattice, {}, Context(threads));
      if (threads == 1) {
        EXPECT_GT(report.split_edges, 100u);
        EXPECT_EQ(count_self_intersections(mesh, context), 0u) << roughness;
        expect_same_topology(mesh, flat.mesh);
        hash = hash_mesh(mesh);
      }
      EXPECT_EQ(hash_mesh(mesh), hash) << roughness;
    }
  }
}

TEST(Bend, RefusesAToleranceOutOfRange) {
  for (const double tolerance : {-0.01, 1.1, std::nan("")}) {
    try {
      validate(RelaxParams{tolerance});
      FAIL() << tolerance;
    } catch (const ParameterError& e) {
      EXPECT_NE(std::string(e.what()).find("must be in [0, 1]"), std::string::npos) << e.what();
    }
  }
}

TEST(Flip, TakesDiagonalsNearerToTheSurface) {
  const Solved solved("torus", 40);
  const Refined flat = refined(solved);
  Mesh mesh = flat.mesh;
  const SmoothField field(flat.field.grid, flat.field.value, Context(1));
  std::vector<Vec3f> normals;
  for (const Vec3d& v : mesh.vertices) {
    const auto jet = field.at(solved.problem.lattice.to_lattice(v));
    ASSERT_TRUE(jet);
    normals.push_back(Vec3f(normalized(jet->gradient)));
  }
  const double voxel = solved.problem.lattice.voxel;
  const auto mean_sag = [&] {
    double sum = 0;
    for (const Triangle& t : mesh.triangles)
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = t[k], b = t[(k + 1) % 3];
        sum += sag(mesh.vertices[a], mesh.vertices[b], normals[a], normals[b]);
      }
    return sum;
  };
  const double at_first = mean_sag();
  HalfEdges edges(mesh);
  EXPECT_GT(flip_edges(edges, normals, voxel, 0.002 * voxel, Context(2)), 0u);
  EXPECT_LT(mean_sag(), 0.97 * at_first);
  EXPECT_EQ(mesh.triangles.size(), flat.mesh.triangles.size());
  expect_same_topology(mesh, flat.mesh);
}

TEST(Flip, KeepsAManifoldWhateverTheNormalsSay) {
  const Solved solved("knot", sanitized ? 32 : 40);
  const Mesh before = refined(solved).mesh;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    Mesh mesh = before;
    Random random(seed);
    std::vector<Vec3f> normals;
    for (size_t v = 0; v < mesh.vertices.size(); ++v)
      normals.push_back(Vec3f(normalized(Vec3d{random.normal(), random.normal(), random.normal()})));
    HalfEdges edges(mesh);
    EXPECT_GT(flip_edges(edges, normals, solved.problem.lattice.voxel, 0, Context(1)), mesh.triangles.size() / 10);
    expect_same_topology(mesh, before);
  }
}

TEST(Flip, LeavesAloneWhatIsNotKnown) {
  const Solved solved("sphere", 30);
  Mesh mesh = refined(solved).mesh;
  const std::vector<Vec3f> unknown(mesh.vertices.size());
  HalfEdges edges(mesh);
  EXPECT_EQ(flip_edges(edges, unknown, 1, 0, Context(1)), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
