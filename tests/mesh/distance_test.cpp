#include "tools/mesh/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "support/flat_sheet.h"
#include "support/shuffled.h"

namespace soapfilm {
namespace TEST_FILE {

/// An octahedron whose triangles are split `levels` times, its vertices on the sphere.
Mesh sphere(double radius, int levels, Vec3d center = {}) {
  Mesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(normalized(mesh.vertices[a] + mesh.vertices[b]));
      return it->second;
    };
    std::vector<Triangle> split;
    for (const Triangle& t : mesh.triangles) {
      const uint32_t ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      for (const Triangle& s :
           {Triangle{t[0], ab, ca}, Triangle{ab, t[1], bc}, Triangle{ca, bc, t[2]}, Triangle{ab, bc, ca}}) {
        split.push_back(s);
      }
    }
    mesh.triangles = split;
  }
  for (Vec3d& v : mesh.vertices) v = center + v * radius;
  return mesh;
}

std::vector<Vec3d> random_points(size_t count, double extent, uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> points(count);
  for (Vec3d& p : points) {
    p = {random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-extent, extent)};
  }
  return points;
}

TEST(Distance, ConcentricSpheresAreTheDifferenceOfRadiiApart) {
  const Mesh inner = sphere(1, 6);
  const Mesh outer = sphere(1.25, 5);
  const DistanceSummary d = point_to_mesh_distance(outer.vertices, inner, Context(2));
  EXPECT_EQ(d.count, outer.vertices.size());
  EXPECT_NEAR(d.mean, 0.25, 2e-4);
  EXPECT_NEAR(d.rms, 0.25, 2e-4);
  EXPECT_NEAR(d.maximum, 0.25, 5e-4);
  EXPECT_GE(d.percentile99, d.percentile95);
  EXPECT_LE(d.percentile99, d.maximum);
}

TEST(Distance, PointsOffAPlaneKnowTheirHeight) {
  const Mesh mesh = test::flat_sheet(10, {0, 0, 0}, 1);
  const auto d =
      distances_to_mesh({{5.3, 4.4, 0.75}, {2.5, 2.25, -3}, {-3, 5, 4}, {14, 13, 0}, {7, 7, 0}}, mesh, Context(1));
  EXPECT_DOUBLE_EQ(d[0], 0.75);
  EXPECT_DOUBLE_EQ(d[1], 3);
  EXPECT_DOUBLE_EQ(d[2], 5);  // beyond the side
  EXPECT_DOUBLE_EQ(d[3], 5);  // beyond the corner
  EXPECT_DOUBLE_EQ(d[4], 0);
}

TEST(Distance, EqualsBruteForceOnRandomTriangles) {
  Random random(11);
  Mesh soup;
  soup.vertices = random_points(600, 1, 12);
  for (uint32_t i = 0; i < 600; i += 3) {
    // Small triangles, a few of them flat.
    for (uint32_t k = 1; k < 3; ++k) soup.vertices[i + k] = soup.vertices[i] + soup.vertices[i + k] * 0.2;
    if (i % 30 == 0) soup.vertices[i + 2] = (soup.vertices[i] + soup.vertices[i + 1]) * 0.5;
    soup.triangles.push_back({i, i + 1, i + 2});
  }
  const auto points = random_points(2000, 1.5, 13);
  const auto found = ClosestPointQuery(soup, Context(1))(points, Context(1));
  for (size_t i = 0; i < points.size(); ++i) {
    double best = std::numeric_limits<double>::infinity();
    uint32_t which = 0;
    for (uint32_t t = 0; t < soup.triangles.size(); ++t) {
      const Triangle& c = soup.triangles[t];
      const Vec3d a = soup.vertices[c[0]], b = soup.vertices[c[1]], e = soup.vertices[c[2]];
      const Vec3d n = cross(b - a, e - a);
      const auto side = [&](Vec3d u, Vec3d v) {
        const double s = std::clamp(dot(points[i] - u, v - u) / dot(v - u, v - u), 0.0, 1.0);
        return norm(points[i] - (u + (v - u) * s));
      };
      double d = std::min({side(a, b), side(b, e), side(e, a)});
      if (norm(n) > 1e-9) {
        const Vec3d foot = points[i] - n * (dot(points[i] - a, n) / dot(n, n));
        if (dot(cross(b - a, foot - a), n) > 0 && dot(cross(e - b, foot - b), n) > 0 &&
            dot(cross(a - e, foot - e), n) > 0) {
          d = norm(points[i] - foot);
        }
      }
      if (d < best) {
        best = d;
        which = t;
      }
    }
    ASSERT_NEAR(found[i].distance, best, 1e-13);
    ASSERT_EQ(found[i].triangle, which);
    ASSERT_NEAR(norm(found[i].position - points[i]), best, 1e-13);
  }
}

TEST(Distance, GeoreferencedOffsetsKeepTheirAccuracy) {
  const Vec3d far{5e6, -5e6, 5e6};
  const Mesh mesh = test::flat_sheet(100, far, 0.01);
  std::vector<Vec3d> points;
  for (int i = 0; i < 90; ++i) points.push_back(far + Vec3d{0.013 + 0.01 * i, 0.5, 1e-3 + 1e-5 * i});
  const auto d = distances_to_mesh(points, mesh, Context(1));
  for (int i = 0; i < 90; ++i) EXPECT_NEAR(d[i], 1e-3 + 1e-5 * i, 2e-9);
}

TEST(Distance, AnyUnitOfLengthWorks) {
  for (const double unit : {1e-30, 1e-12, 1e12, 1e30}) {
    Mesh mesh = sphere(1, 3);
    for (Vec3d& v : mesh.vertices) v = v * unit;
    EXPECT_NEAR(ClosestPointQuery(mesh, Context(1))({0, 0, 3 * unit}).distance / unit, 2, 1e-12);
  }
}

TEST(Distance, AMeshShrunkToAPointStillHasADistance) {
  Mesh mesh = sphere(1, 0);
  for (Vec3d& v : mesh.vertices) v = {1, 2, 3};
  EXPECT_DOUBLE_EQ(ClosestPointQuery(mesh, Context(1))({1, 2, 5}).distance, 2);
  EXPECT_DOUBLE_EQ(ClosestPointQuery(mesh, Context(1))({1, 2, 3}).distance, 0);
}

TEST(Distance, PointsFarFromTheMeshAreMeasuredToo) {
  const auto d = distances_to_mesh({{0, 0, 1e7}, {0, 0, 1e7 + 1}}, test::flat_sheet(4, {-2, -2, 0}, 1), Context(1));
  EXPECT_DOUBLE_EQ(d[0], 1e7);
  EXPECT_DOUBLE_EQ(d[1], 1e7 + 1);
}

TEST(Distance, TheSameByParts) {
  Mesh mesh = sphere(1, 4, {1e6, -3, 7});
  const std::vector<Vec3d> near = random_points(5000, 1.2, 5), far = random_points(200, 40, 6);
  std::vector<Vec3d> points = near;
  points.insert(points.end(), far.begin(), far.end());
  points.insert(points.end(), mesh.vertices.begin(), mesh.vertices.end());  // at a distance of 0, in several parts
  for (size_t i = 0; i < near.size() + far.size(); ++i) points[i] += Vec3d{1e6, -3, 7};
  for (const bool shuffled : {false, true}) {
    if (shuffled)
      mesh.triangles =
          test::in_order(mesh.triangles, test::random_order(mesh.triangles.size(), 8));  // then each part is everywhere
    const std::vector<double> expected = distances_to_mesh(points, mesh, Context(1));
    for (const size_t part : {size_t{1} << 20, mesh.triangles.size(), size_t{500}, size_t{37}})
      for (const int threads : {1, 3}) ASSERT_EQ(distances_by_parts(points, mesh, part, Context(threads)), expected);
  }
}

TEST(Distance, ByPartsRefusesTheSame) {
  EXPECT_THROW(distances_by_parts({{0, 0, 0}}, Mesh{}, 10, Context(1)), ParameterError);
  EXPECT_THROW(distances_by_parts({{0, 0, std::nan("")}}, test::flat_sheet(4, {}, 1), 10, Context(1)), ParameterError);
  Mesh bad = test::flat_sheet(4, {}, 1);
  bad.triangles[20][1] = static_cast<uint32_t>(bad.vertices.size());
  EXPECT_THROW(distances_by_parts({{0, 0, 0}}, bad, 10, Context(1)), ParameterError);
}

TEST(Distance, TheSameForAnyNumberOfThreads) {
  const Mesh mesh = sphere(1, 4);
  const auto points = random_points(20000, 1.2, 5);
  const auto one = ClosestPointQuery(mesh, Context(1))(points, Context(1));
  for (const int threads : {2, 3, 8}) {
    const auto many = ClosestPointQuery(mesh, Context(threads))(points, Context(threads));
    for (size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(many[i].distance, one[i].distance);
      ASSERT_EQ(many[i].triangle, one[i].triangle);
    }
  }
}

TEST(Distance, OnePointAloneAgreesWithManyAtOnce) {
  const ClosestPointQuery query(sphere(1, 3), Context(1));
  const auto points = random_points(500, 2, 6);
  const auto all = query(points, Context(1));
  for (size_t i = 0; i < points.size(); ++i) EXPECT_EQ(query(points[i]).distance, all[i].distance);
}

TEST(Distance, SummaryOfKnownNumbers) {
  std::vector<double> values;
  for (int i = 200; i >= 1; --i) values.push_back(i);
  const DistanceSummary d = summarize(values);
  EXPECT_DOUBLE_EQ(d.mean, 100.5);
  EXPECT_DOUBLE_EQ(d.rms, std::sqrt(201.0 * 401.0 / 6));
  EXPECT_DOUBLE_EQ(d.maximum, 200);
  EXPECT_DOUBLE_EQ(d.percentile95, 190);
  EXPECT_DOUBLE_EQ(d.percentile99, 198);
  EXPECT_EQ(summarize({}).count, 0u);
}

TEST(Distance, RefusesWhatHasNoDistance) {
  EXPECT_THROW(ClosestPointQuery(Mesh{}, Context(1)), ParameterError);
  EXPECT_THROW(ClosestPointQuery(test::flat_sheet(1, {}, 1e200), Context(1)), ParameterError);
  Mesh bad = test::flat_sheet(1, {}, 1);
  bad.triangles[0][0] = 99;
  EXPECT_THROW(ClosestPointQuery(bad, Context(1)), ParameterError);
  bad = test::flat_sheet(1, {}, 1);
  bad.vertices[2].y = std::nan("");
  EXPECT_THROW(ClosestPointQuery(bad, Context(1)), ParameterError);
  EXPECT_THROW(distances_to_mesh({{0, 0, std::nan("")}}, test::flat_sheet(1, {}, 1), Context(1)), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
