#include "tools/evaluate/evaluate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "soapfilm/error.h"
#include "support/flat_sheet.h"
#include "tools/mesh/sample_mesh.h"
#include "tools/render/colormap.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

Evaluation evaluated(const Mesh& mesh, const Surface& truth, EvaluationOptions options = {}) {
  options.points = std::min<size_t>(options.points, 20000);
  return evaluate(mesh, truth, options, Context(2));
}

Mesh sphere_mesh(double size, double tolerance = 1e-4) { return make_sphere({.size = size})->tessellate(tolerance); }

/// n x n squares over the unit square at height z.
Mesh sheet(uint32_t n, double z) { return test::flat_sheet(n, {0, 0, z}, 1.0 / n); }

TEST(Evaluate, ConcentricSpheresAreTheDifferenceOfRadiiApart) {
  const auto truth = make_sphere({.size = 2.0});
  const Evaluation e = evaluated(sphere_mesh(2.5), *truth, {.f_score_distances = {0.2, 0.3}});
  for (const DirectedError* error : {&e.truth_to_mesh, &e.mesh_to_truth}) {
    EXPECT_EQ(error->distance.count, 20000u);
    EXPECT_NEAR(error->distance.mean, 0.25, 1e-4);
    EXPECT_NEAR(error->distance.rms, 0.25, 1e-4);
    EXPECT_NEAR(error->distance.percentile95, 0.25, 1e-4);
    EXPECT_NEAR(error->distance.percentile99, 0.25, 1e-4);
    EXPECT_NEAR(error->distance.maximum, 0.25, 1e-4);
    EXPECT_LT(error->angle.mean, 1.0) << "facets are that much off the sphere's normals";
  }
  EXPECT_EQ(e.f_scores[0].score(), 0.0);
  EXPECT_EQ(e.f_scores[1].score(), 1.0);
  EXPECT_NEAR(*e.volume.truth, 4.0 / 3.0 * std::numbers::pi, 1e-12) << "a shape's is exact";
  EXPECT_NEAR(*e.volume.relative_error(), std::pow(1.25, 3) - 1.0, 5e-4);
  EXPECT_NEAR(*e.area.relative_error(), 1.25 * 1.25 - 1.0, 5e-4);
  EXPECT_EQ(e.topology.genus(), 0);
  EXPECT_EQ(e.self_intersections, 0u);
  EXPECT_FALSE(e.samples_to_mesh);
}

TEST(Evaluate, ShiftedSheetsAreTheShiftApart) {
  const Evaluation e = evaluate(sheet(7, 0.125), sheet(4, 0.0), {.points = 5000}, Context(1));
  EXPECT_DOUBLE_EQ(e.truth_to_mesh.distance.mean, 0.125);
  EXPECT_DOUBLE_EQ(e.mesh_to_truth.distance.maximum, 0.125);
  EXPECT_DOUBLE_EQ(e.mesh_to_truth.angle.maximum, 0.0);
  EXPECT_FALSE(e.volume.mesh) << "open surfaces enclose nothing";
  EXPECT_FALSE(e.volume.relative_error());
  EXPECT_NEAR(*e.area.relative_error(), 0.0, 1e-12);
}

TEST(Evaluate, APartThatIsMissingShowsInOneDirectionOnly) {
  // The left half of the square: the truth's right half is 0 to 1/2 away, 1/8 in the mean.
  Mesh half = sheet(8, 0.0);
  for (Vec3d& v : half.vertices) v.x *= 0.5;
  const Evaluation e = evaluate(half, sheet(8, 0.0), {.points = 40000, .f_score_distances = {0.25}}, Context(2));
  EXPECT_NEAR(e.mesh_to_truth.distance.maximum, 0.0, 1e-15);
  EXPECT_NEAR(e.truth_to_mesh.distance.mean, 0.125, 1e-3);
  EXPECT_NEAR(e.truth_to_mesh.distance.rms, std::sqrt(1.0 / 24.0), 1e-3);
  EXPECT_NEAR(e.truth_to_mesh.distance.percentile95, 0.45, 2e-3);
  EXPECT_NEAR(e.truth_to_mesh.distance.maximum, 0.5, 2e-3);
  EXPECT_EQ(e.f_scores[0].precision, 1.0);
  EXPECT_NEAR(e.f_scores[0].recall, 0.75, 2e-3);
  EXPECT_NEAR(e.f_scores[0].score(), 6.0 / 7.0, 2e-3);
}

TEST(Evaluate, TiltedSheetsHaveTheTiltAsTheirAngle) {
  Mesh tilted = sheet(4, 0.0);
  const double angle = 10.0 / 180.0 * std::numbers::pi;
  for (Vec3d& v : tilted.vertices) v = {v.x * std::cos(angle), v.y, v.x * std::sin(angle)};
  const Evaluation e = evaluate(tilted, sheet(4, 0.0), {.points = 2000}, Context(1));
  EXPECT_NEAR(e.truth_to_mesh.angle.mean, 10.0, 1e-9);
  EXPECT_NEAR(e.mesh_to_truth.angle.percentile95, 10.0, 1e-9);
}

TEST(Evaluate, AnInsideOutMeshIsHalfATurnOff) {
  Mesh mesh = sphere_mesh(1.0);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  const Evaluation e = evaluated(mesh, *make_sphere());
  EXPECT_GT(e.truth_to_mesh.angle.mean, 179.0);
  EXPECT_NEAR(*e.volume.relative_error(), -2.0, 1e-3);
}

/// Triangles without area come first in the list, so that they win ties, and some of the truth is closest to them.
TEST(Evaluate, ATriangleWithoutAreaIsNoPerfectNormal) {
  const Mesh truth = sheet(4, 0.25);
  Mesh mesh = sheet(4, 0.0);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  const auto line = static_cast<uint32_t>(mesh.vertices.size());  // within 1/4 of it lies half of the truth
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0.5, 0.25}, {0.3, 0.5, 0.25}, {1, 0.5, 0.25}});
  mesh.triangles.insert(mesh.triangles.begin(), {line, line + 1, line + 2});
  const Evaluation e = evaluate(mesh, truth, {.points = 5000}, Context(1));
  EXPECT_EQ(e.topology.zero_area_triangles, 1u);
  EXPECT_EQ(e.truth_to_mesh.distance.count, 5000u);
  EXPECT_NEAR(static_cast<double>(e.truth_to_mesh.angle.count), 2500.0, 50.0);
  EXPECT_DOUBLE_EQ(e.truth_to_mesh.angle.mean, 180.0);
  EXPECT_EQ(e.mesh_to_truth.angle.count, 5000u);
  EXPECT_DOUBLE_EQ(e.mesh_to_truth.angle.mean, 180.0);
  const Evaluation swapped = evaluate(truth, mesh, {.points = 5000}, Context(1));
  EXPECT_EQ(swapped.mesh_to_truth.angle.count, e.truth_to_mesh.angle.count) << "of the truth neither";
  EXPECT_DOUBLE_EQ(swapped.mesh_to_truth.angle.mean, 180.0);
}

TEST(Evaluate, WithoutAnyNormalThereAreNoAngles) {
  Mesh mesh = sheet(1, 0.0);
  const auto line = static_cast<uint32_t>(mesh.vertices.size());  // closer to all of the truth than the sheet
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0.5, 0.9}, {0.3, 0.5, 0.9}, {1, 0.5, 0.9}});
  mesh.triangles.push_back({line, line + 1, line + 2});
  const Evaluation e = evaluate(mesh, sheet(1, 1.0), {.points = 1000}, Context(1));
  EXPECT_EQ(e.truth_to_mesh.angle.count, 0u);
  EXPECT_EQ(e.mesh_to_truth.angle.count, 1000u);
}

/// The sign of an open surface's volume is its shape's or rounding's: one of these two would be turned by it.
TEST(Evaluate, AnOpenTruthIsTakenAsItIs) {
  Mesh corner;
  corner.vertices = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  corner.triangles = {{0, 1, 2}};
  for (const bool reversed : {false, true}) {
    if (reversed) std::swap(corner.triangles[0][0], corner.triangles[0][1]);
    const Evaluation e = evaluate(corner, corner, {.points = 100}, Context(1));
    EXPECT_EQ(e.truth_to_mesh.angle.maximum, 0.0) << reversed;
    EXPECT_EQ(e.mesh_to_truth.angle.maximum, 0.0) << reversed;
    EXPECT_FALSE(e.volume.truth) << reversed;
  }
}

TEST(Evaluate, AShapeAgainstItsOwnTessellationHasTheChordsErrorSlow) {
  for (const std::string& name : shape_names()) {
    const auto shape = make_shape(name);
    const Evaluation e = evaluated(shape->tessellate(1e-3), *shape);
    // The knot's tessellation cuts its creases.
    EXPECT_LT(e.truth_to_mesh.distance.maximum, name == "knot" ? 2e-2 : 3e-3) << name;
    EXPECT_LT(e.mesh_to_truth.distance.mean, 1e-3) << name;
    EXPECT_EQ(e.topology.genus(), shape->facts().genus) << name;
    EXPECT_EQ(e.truth_topology.components.size(), static_cast<size_t>(shape->facts().components)) << name;
    EXPECT_LT(std::abs(e.volume.relative_error().value()), 2e-2) << name;
  }
}

TEST(Evaluate, SamplesAreMeasuredAgainstTheMesh) {
  const std::vector<Vec3d> samples{{0.5, 0.5, 1.0}, {0.5, 0.5, -3.0}};
  const Mesh mesh = sheet(2, 0.0);
  const Evaluation e = evaluate(mesh, MeshSurface(mesh, Context(1)), {.points = 10}, Context(1), &samples);
  EXPECT_EQ(e.samples_to_mesh->count, 2u);
  EXPECT_DOUBLE_EQ(e.samples_to_mesh->mean, 2.0);
  EXPECT_DOUBLE_EQ(e.samples_to_mesh->maximum, 3.0);
}

TEST(Evaluate, GeoreferencedSurfacesLoseNothing) {
  const Vec3d far{5e6, -5e6, 5e6};
  ShapeParams params;
  params.center = far;
  Mesh mesh = sphere_mesh(1.01);
  const Evaluation here = evaluated(mesh, *make_sphere());
  for (Vec3d& v : mesh.vertices) v += far;
  const Evaluation there = evaluated(mesh, *make_sphere(params));
  EXPECT_NEAR(there.mesh_to_truth.distance.mean, here.mesh_to_truth.distance.mean, 2e-9);
  EXPECT_NEAR(there.truth_to_mesh.distance.maximum, here.truth_to_mesh.distance.maximum, 4e-9);
  EXPECT_NEAR(*there.volume.mesh, *here.volume.mesh, 1e-8);
}

TEST(Evaluate, TheSameForAnyNumberOfThreads) {
  const Mesh mesh = make_part()->tessellate(1e-3);
  const auto truth = make_torus();
  const EvaluationOptions options{.points = 6000, .f_score_distances = {0.05}};
  const Evaluation one = evaluate(mesh, *truth, options, Context(1));
  for (const int threads : {2, 5}) {
    const Evaluation many = evaluate(mesh, *truth, options, Context(threads));
    EXPECT_EQ(many.truth_to_mesh.distance.mean, one.truth_to_mesh.distance.mean);
    EXPECT_EQ(many.mesh_to_truth.distance.rms, one.mesh_to_truth.distance.rms);
    EXPECT_EQ(many.mesh_to_truth.angle.mean, one.mesh_to_truth.angle.mean);
    EXPECT_EQ(many.f_scores[0].score(), one.f_scores[0].score());
    EXPECT_EQ(many.self_intersections, one.self_intersections);
  }
}

TEST(Evaluate, ErrorsAreColorsAndAnAttribute) {
  Mesh mesh = sheet(1, 0.0);
  mesh.vertices[0].z = 0.5;
  mesh.vertices[1].z = 2.0;
  mesh.attributes = {{"distance", {9, 9, 9, 9}}, {"kept", {1, 2, 3, 4}}};
  const Mesh colored = color_by_error(mesh, MeshSurface(sheet(9, 0.0), Context(1)), 1.0, Context(1));
  ASSERT_EQ(colored.attributes.size(), 2u);
  EXPECT_EQ(colored.attributes[0].name, "kept");
  EXPECT_EQ(colored.attributes[1].values, (std::vector<float>{0.5f, 2.0f, 0.0f, 0.0f}));
  EXPECT_EQ(colored.colors[1], map_color(1.0)) << "beyond the range";
  EXPECT_EQ(colored.colors[2], map_color(0.0));
  EXPECT_THROW(color_by_error(mesh, *make_sphere(), 0.0, Context(1)), ParameterError);
}

TEST(Evaluate, RefusalsNameTheValueAndItsConstraint) {
  const auto message = [](const Mesh& mesh, const EvaluationOptions& options) -> std::string {
    try {
      evaluate(mesh, sheet(1, 0.0), options, Context(1));
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message(sheet(1, 0.0), {.points = 0}), "points = 0, must be in [1, 1e8]");
  EXPECT_EQ(message(sheet(1, 0.0), {.f_score_distances = {0.0}}), "f_score = 0, must be > 0 and finite");
  Mesh line = sheet(1, 0.0);
  for (Vec3d& v : line.vertices) v.x = 0.0;
  EXPECT_EQ(message(line, {.points = 10}), "the mesh has no area, it must have some");
}

TEST(SampleMesh, EachPartOfTheAreaGetsItsShare) {
  // Two triangles, one nine times as large as the other.
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 5}, {3, 0, 5}, {0, 3, 5}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  size_t small = 0;
  Vec3d mean;
  for (const MeshPoint& p : sample_mesh(mesh, 10000, 1, Context(1))) {
    ASSERT_EQ(p.triangle, p.position.z > 1 ? 1u : 0u);
    ASSERT_GE(p.position.x, 0.0);
    ASSERT_LE(p.position.x + p.position.y, p.triangle == 1 ? 3.0 + 1e-12 : 1.0 + 1e-12);
    if (p.triangle == 0) {
      ++small;
      mean += p.position;
    }
  }
  EXPECT_EQ(small, 1000u);
  EXPECT_LE(norm(mean / 1000.0 - Vec3d{1.0 / 3, 1.0 / 3, 0}), 0.03);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
