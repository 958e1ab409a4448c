// Levels of detail: each is as near to the full mesh as is said, closed where that is, and has fewer triangles.
#include "soapfilm/simplify/coarser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "relax/grid_torus.h"
#include "soapfilm/core/vec.h"
#include "support/farthest.h"
#include "support/flat_sheet.h"
#include "support/sanitized.h"
#include "tools/mesh/self_intersection.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context two_threads(2);

Mesh wavy(uint32_t n) {
  Mesh mesh = grid_torus({10, 20, 30}, 2, 0.7, 2 * n, n);
  Column height{"height", {}, false};
  for (Vec3d& v : mesh.vertices) {
    v.z += 0.05 * std::sin(9 * v.x) * std::cos(7 * v.y);
    height.values.push_back(static_cast<float>(v.z));
  }
  mesh.attributes.push_back(height);
  return mesh;
}

TEST(CoarserLevels, AreWithinTheSumOfAllStepsOfTheFullMesh) {
  const Mesh full = wavy(sanitized ? 40 : 100);
  const Simplified first = simplify(full, 0.002, two_threads);
  const std::vector<Simplified> levels = coarser_levels(first, 5, two_threads);
  ASSERT_EQ(levels.size(), 5u);
  double tolerance = 0.002, allowed = 0.002;
  size_t triangles = first.report.triangles;
  for (const auto& [mesh, report] : levels) {
    tolerance *= 2;
    allowed += tolerance;
    EXPECT_EQ(report.tolerance, tolerance);
    EXPECT_EQ(report.triangles_before, triangles);
    EXPECT_EQ(report.triangles, mesh.triangles.size());
    EXPECT_LT(report.triangles, triangles);
    triangles = report.triangles;
    EXPECT_LE(report.proved, allowed * (1 + 1e-12));
    EXPECT_GT(report.proved, tolerance) << "the steps before count, too";
    const double measured = farthest_between(mesh, full, two_threads);
    EXPECT_LE(measured, report.proved);
    EXPECT_GT(measured, 0.1 * report.proved) << "the bound is not far off";
    const TopologyReport topology = check_topology(mesh);
    EXPECT_TRUE(topology.watertight());
    EXPECT_EQ(topology.genus(), 1);
    EXPECT_EQ(count_self_intersections(mesh, two_threads), 0u);
    ASSERT_EQ(mesh.attributes.size(), 1u);
    for (size_t v = 0; v < mesh.vertices.size(); ++v)
      EXPECT_NEAR(mesh.attributes[0].values[v], mesh.vertices[v].z, 2 * report.proved);
  }
}

TEST(CoarserLevels, EndWhereNothingIsLeftToTakeAway) {
  const Simplified first = simplify(flat_sheet(10, {0, 0, 0}, 1), 0.1, two_threads);
  const std::vector<Simplified> levels = coarser_levels(first, 8, two_threads);
  ASSERT_LT(levels.size(), 8u);
  for (const Simplified& level : levels) EXPECT_GE(level.report.triangles, 2u);
}

TEST(CoarserLevels, ThreadsDoNotMatter) {
  const Mesh full = wavy(40);
  const auto of = [&](int threads) {
    const Context context(threads);
    return coarser_levels(simplify(full, 0.004, context), 4, context);
  };
  const std::vector<Simplified> one = of(1), four = of(4);
  ASSERT_EQ(one.size(), four.size());
  for (size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].mesh.vertices, four[k].mesh.vertices);
    EXPECT_EQ(one[k].mesh.triangles, four[k].mesh.triangles);
    EXPECT_EQ(one[k].report.proved, four[k].report.proved);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
