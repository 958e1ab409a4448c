#include "tools/compare/compare.h"

#include <gtest/gtest.h>

#include <numeric>

#include "measure/solids.h"
#include "soapfilm/error.h"
#include "tools/compare/compare_report.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

Mesh ball(double radius) { return make_sphere({.size = 2 * radius})->tessellate(1e-4); }

CompareOptions options_of(double tolerance) {
  CompareOptions options;
  options.tolerance = tolerance;
  options.points = 5000;
  return options;
}

TEST(Compare, AMeshWithItselfIsNothing) {
  MeshPart part{make_part()->tessellate(1e-3), {}};
  const Comparison c = compare(part, part.mesh, options_of(1e-9), Context(2));
  for (const Deviations* d : {&c.part_to_model, &*c.model_to_part}) {
    EXPECT_LT(d->rms, 1e-14);
    EXPECT_EQ(d->within, 1);
    EXPECT_EQ(d->above + d->below, 0);
  }
  EXPECT_EQ(c.within_tolerance, true);
  for (const double d : part.distances) EXPECT_NEAR(d, 0, 1e-14);
}

TEST(Compare, AnOffsetHasItsSizeAndItsSignFromBothSides) {
  for (const double offset : {0.02, -0.02}) {
    MeshPart part{ball(1 + offset), {}};
    const Comparison c = compare(part, ball(1), options_of(0.01), Context(2));
    for (const Deviations* d : {&c.part_to_model, &*c.model_to_part}) {
      EXPECT_NEAR(d->mean, offset, 2e-4);
      EXPECT_NEAR(d->rms, std::abs(offset), 2e-4);
      EXPECT_NEAR(d->lowest, offset, 5e-4);
      EXPECT_NEAR(d->highest, offset, 5e-4);
      EXPECT_EQ(d->above, offset > 0 ? 1 : 0);
      EXPECT_EQ(d->below, offset < 0 ? 1 : 0);
    }
    EXPECT_EQ(c.within_tolerance, false);
    EXPECT_EQ(compare(part, ball(1), options_of(0.021), Context(2)).within_tolerance, true);
  }
}

TEST(Compare, SignsAreRightAroundSharpEdges) {
  // Points around a box, far from its edges and near: inside exactly where all coordinates are.
  const Mesh box = box_mesh({-1, -1, -1}, {1, 1, 1});
  const SignedDistance distance(box, Context(1));
  Random random(1);
  std::vector<Vec3d> points;
  for (int i = 0; i < 20000; ++i)
    points.push_back({random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)});
  const std::vector<SignedPoint> found = distance(points, Context(2));
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3d p = points[i];
    const Vec3d beyond{std::max(std::abs(p.x) - 1, 0.0), std::max(std::abs(p.y) - 1, 0.0),
                       std::max(std::abs(p.z) - 1, 0.0)};
    const double most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    EXPECT_NEAR(found[i].distance, most <= 1 ? most - 1 : norm(beyond), 1e-12);
    EXPECT_NEAR(norm(found[i].normal), 1, 1e-12);
  }
}

TEST(Compare, SharpTipsHaveTheirSidesToo) {
  // A thin needle: most normals of its tip look sideways, and a mean that is not weighted by angles would be wrong.
  Mesh needle;
  needle.vertices = {{0, 0, 5}, {0.1, 0, 0}, {-0.1, 0.02, 0}, {-0.1, -0.02, 0}, {0.0, -0.011, 0}};
  needle.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {2, 1, 3}, {3, 1, 4}};
  ASSERT_TRUE(check_topology(needle).closed());
  ASSERT_GT(needle.volume(), 0);
  const SignedDistance distance(needle, Context(1));
  Random random(2);
  std::vector<Vec3d> outside;
  for (int i = 0; i < 2000; ++i)
    outside.push_back(Vec3d{0, 0, 5} + Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 1)});
  for (const SignedPoint& p : distance(outside, Context(1))) EXPECT_GT(p.distance, 0);
}

TEST(Compare, AMeshOfSeparateTrianglesHasTheSameSigns) {
  const Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  Mesh soup;
  for (const Triangle& t : box.triangles) {
    const auto first = static_cast<uint32_t>(soup.vertices.size());
    for (const uint32_t v : t) soup.vertices.push_back(box.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const std::vector<Vec3d> points{{1.2, 1.1, 0.5}, {1.1, 1.1, 1.3}, {-0.1, -0.1, -0.1}, {0.9, 0.9, 0.5}};
  const auto whole = SignedDistance(box, Context(1))(points, Context(1));
  const auto parts = SignedDistance(soup, Context(1))(points, Context(1));
  for (size_t i = 0; i < points.size(); ++i) EXPECT_EQ(parts[i].distance, whole[i].distance);
}

TEST(Compare, WhatThePartLacksIsSeenFromTheModel) {
  // The upper half of a box is missing.
  MeshPart part{box_mesh({0, 0, 0}, {1, 1, 0.5}), {}};
  const Comparison c = compare(part, box_mesh({0, 0, 0}, {1, 1, 1}), options_of(0.1), Context(2));
  EXPECT_NEAR(c.model_to_part->lowest, -0.5, 1e-2);
  EXPECT_EQ(c.model_to_part->above, 0);
  // Of the model's area of 6 the lid and four sides beyond 0.6 are: 1 + 4 * 0.4.
  EXPECT_NEAR(c.model_to_part->below, 2.6 / 6, 1e-2);
  EXPECT_NEAR(c.part_to_model.below, 0.8 * 0.8 / 4, 1e-2) << "its lid, but for a margin";
}

TEST(Compare, AScanIsMeasuredAtItsSamples) {
  ScanPart scan{sample_surface(*make_sphere({.size = 2.02}), 3000, 1), {}};
  CompareOptions options = options_of(0.02);
  const Comparison c = compare(scan, ball(1), options, Context(2));
  EXPECT_EQ(c.part_to_model.points, 3000u);
  EXPECT_FALSE(c.model_to_part);
  EXPECT_NEAR(c.part_to_model.mean, 0.01, 2e-4);
  EXPECT_EQ(c.within_tolerance, true);
  ASSERT_EQ(scan.distances.size(), 3000u);
  const PointCloud colored = color_by_deviation(scan, 0.02);
  EXPECT_EQ(colored.colors.size(), 3000u);
  EXPECT_NEAR(colored.columns.back().values[7], 0.01F, 2e-4F);
}

TEST(Compare, TheShareDecides) {
  ScanPart scan{sample_surface(*make_sphere({.size = 2}), 1000, 1), {}};
  for (size_t i = 0; i < 50; ++i) scan.cloud.positions[i] = scan.cloud.positions[i] * (i < 30 ? 1.1 : 0.9);
  CompareOptions options = options_of(0.05);
  Comparison c = compare(scan, ball(1), options, Context(1));
  EXPECT_NEAR(c.part_to_model.within, 0.95, 1e-12);
  EXPECT_NEAR(c.part_to_model.above, 0.03, 1e-12);
  EXPECT_NEAR(c.part_to_model.below, 0.02, 1e-12);
  EXPECT_EQ(c.within_tolerance, false);
  options.least = 0.95;
  EXPECT_EQ(compare(scan, ball(1), options, Context(1)).within_tolerance, true);
  options.tolerance = 0;
  EXPECT_FALSE(compare(scan, ball(1), options, Context(1)).within_tolerance);
}

TEST(Compare, HistogramsHoldAllPoints) {
  MeshPart part{ball(1.02), {}};
  for (const size_t bins : {1, 2, 21}) {
    CompareOptions options = options_of(0.005);  // bins to 0.01: all beyond
    options.bins = bins;
    const Deviations d = compare(part, ball(1), options, Context(1)).part_to_model;
    ASSERT_EQ(d.histogram.size(), bins);
    EXPECT_EQ(d.histogram.back(), d.points);
    EXPECT_EQ(std::accumulate(d.histogram.begin(), d.histogram.end(), size_t{0}), d.points);
  }
}

TEST(Compare, AlignedItIsCompareInPlace) {
  Random random(3);
  const Mesh model = make_part()->tessellate(1e-3);
  MeshPart part{model, {}};
  for (Vec3d& v : part.mesh.vertices) v = {v.x * 0.9998 - v.y * 0.02 + 0.02, v.x * 0.02 + v.y * 0.9998, v.z + 0.01};
  MeshPart still = part;
  CompareOptions options = options_of(1e-3);
  EXPECT_EQ(compare(still, model, options, Context(2)).within_tolerance, false);
  options.align = true;
  const Comparison c = compare(part, model, options, Context(2));
  EXPECT_EQ(c.within_tolerance, true);
  EXPECT_LT(c.part_to_model.rms, 1e-4);
  EXPECT_LT(c.model_to_part->rms, 1e-4);
  for (size_t i = 0; i < model.vertices.size(); i += 100)
    EXPECT_LT(norm(part.mesh.vertices[i] - model.vertices[i]), 1e-3) << "it was moved";
}

TEST(Compare, FlipsWhatIsInsideOut) {
  MeshPart part{flipped(ball(1.02)), {}};
  const Comparison c = compare(part, flipped(ball(1)), options_of(0.01), Context(1));
  EXPECT_NEAR(c.part_to_model.mean, 0.02, 2e-4);
  EXPECT_NEAR(c.model_to_part->mean, 0.02, 2e-4);
}

TEST(Compare, ColorsAreGreenAtZeroRedAboveBlueBelow) {
  MeshPart part{box_mesh({0, 0, 0}, {1, 1, 1}), {-1, 0, 1, 5, 0, 0, 0, 0}};
  part.mesh.attributes = {{"distance", std::vector<float>(8, 9)}};
  const Mesh mesh = color_by_deviation(part, 1);
  ASSERT_EQ(mesh.attributes.size(), 1u);
  EXPECT_EQ(mesh.attributes[0].values, (std::vector<float>{-1, 0, 1, 5, 0, 0, 0, 0}));
  EXPECT_GT(mesh.colors[0][2], 150);
  EXPECT_LT(mesh.colors[0][0], 80);
  EXPECT_GT(mesh.colors[1][1], mesh.colors[1][0]);
  EXPECT_GT(mesh.colors[2][0], 150);
  EXPECT_EQ(mesh.colors[3], mesh.colors[2]);
  EXPECT_THROW(color_by_deviation(part, 0), ParameterError);
}

TEST(Compare, TheSameForAnyNumberOfThreads) {
  const Mesh model = make_part()->tessellate(1e-2);
  MeshPart one{make_part()->tessellate(3e-3), {}}, many = one;
  const CompareSubject subject{"a", "b", false, "mm", options_of(0.01)};
  const std::string first = compare_json(subject, compare(one, model, subject.options, Context(1))).dump();
  EXPECT_EQ(compare_json(subject, compare(many, model, subject.options, Context(3))).dump(), first);
  EXPECT_EQ(one.distances, many.distances);
}

TEST(Compare, RefusesOptionsOutOfRange) {
  for (const auto& change : std::vector<std::function<void(CompareOptions&)>>{
           [](CompareOptions& o) { o.tolerance = -1; }, [](CompareOptions& o) { o.least = 0; },
           [](CompareOptions& o) { o.least = 1.1; }, [](CompareOptions& o) { o.points = 0; },
           [](CompareOptions& o) { o.bins = 0; }}) {
    CompareOptions options = options_of(1);
    change(options);
    EXPECT_THROW(validate(options), ParameterError);
  }
  ScanPart nothing;
  EXPECT_THROW(compare(nothing, ball(1), options_of(1), Context(1)), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
