#include "tools/scanner/missing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "soapfilm/error.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/surface_patch.h"

namespace soapfilm {
namespace TEST_FILE {

class EveryShapeWithAHole : public testing::TestWithParam<std::string> {};

TEST_P(EveryShapeWithAHole, LosesTheShareOfItsArea) {
  const auto shape = make_shape(GetParam());
  PointCloud cloud = sample_surface(*shape, 20000, 99);
  const std::vector<bool> keep = kept_samples(*shape, cloud, {.hole = 0.1, .seed = 3}, Context(2));
  EXPECT_NEAR(static_cast<double>(std::count(keep.begin(), keep.end(), false)), 2000.0, 200.0);
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShapeWithAHole, testing::ValuesIn(shape_names()),
                         [](const auto& each) { return each.param; });

TEST(Hole, IsACapOfASphere) {
  const auto shape = make_sphere();
  const double share = 0.1;
  const SurfacePatch patch(*shape, share, 4);
  const Vec3d pole = normalized(patch.center());
  const double least_cosine = 1.0 - 2.0 * share;  // Archimedes: a cap's area goes with its height
  const PointCloud cloud = sample_surface(*shape, 5000, 1);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const double cosine = dot(normalized(cloud.positions[i]), pole);
    if (std::abs(cosine - least_cosine) < 0.03) continue;  // the border is a spacing of the reference wide
    ASSERT_EQ(patch.contains(shape->closest(cloud.positions[i])), cosine > least_cosine);
  }
}

TEST(Hole, TakesOneSideOfAThinPlate) {
  const auto plate = make_plate({.thickness = 0.01});
  const double share = 0.03;
  const SurfacePatch patch(*plate, share, 8);  // a disc that does not reach the rim
  const double side = patch.center().z > 0 ? 1.0 : -1.0;
  const PointCloud cloud = sample_surface(*plate, 20000, 1);
  size_t lost = 0;
  for (const Vec3d& p : cloud.positions) {
    if (!patch.contains(plate->closest(p))) continue;
    ++lost;
    ASSERT_GT(p.z * side, -0.005);
  }
  EXPECT_NEAR(static_cast<double>(lost), share * 20000, 80.0);
  // On the side itself it is a disc: no sample within its radius stays but for its border.
  const double radius = std::sqrt(share * *plate->facts().area / std::numbers::pi);
  for (const Vec3d& p : cloud.positions) {
    if (p.z * side < 0.00499 || std::hypot(p.x - patch.center().x, p.y - patch.center().y) > 0.9 * radius) continue;
    ASSERT_TRUE(patch.contains(plate->closest(p)));
  }
}

TEST(Hole, DependsOnTheSeedAlone) {
  const auto shape = make_torus();
  EXPECT_EQ(SurfacePatch(*shape, 0.1, 7).center(), SurfacePatch(*shape, 0.2, 7).center());
  EXPECT_NE(SurfacePatch(*shape, 0.1, 7).center(), SurfacePatch(*shape, 0.1, 8).center());
  const PointCloud cloud = sample_surface(*shape, 2000, 1);
  EXPECT_EQ(kept_samples(*shape, cloud, {.hole = 0.1}, Context(1)),
            kept_samples(*shape, cloud, {.hole = 0.1}, Context(3)));
}

TEST(ThinHalf, KeepsOneOfFiftyBeyondTheMiddleOfTheLongestSide) {
  const auto shape = make_arch();  // longest along z
  const PointCloud cloud = sample_surface(*shape, 50000, 1);
  const std::vector<bool> keep = kept_samples(*shape, cloud, {.sparse_half = 50}, Context(1));
  double upper = 0, kept_upper = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.positions[i].z <= 0) {
      ASSERT_TRUE(keep[i]);
    } else {
      upper += 1;
      kept_upper += keep[i] ? 1 : 0;
    }
  }
  EXPECT_NEAR(kept_upper, upper / 50, 4.5 * std::sqrt(upper / 50));
}

TEST(Missing, ScansKeepTheirRangeGridsAndPoses) {
  const auto shape = make_part();
  ScannerParams params;
  params.views = 8;
  params.columns = params.rows = 50;
  ScanSet set = virtual_scan(*shape, params, Context(2));
  const ScanSet whole = set;
  std::vector<bool> keep = kept_samples(*shape, set.cloud, {.hole = 0.2, .sparse_half = 3}, Context(1));
  const Scan& gone = whole.cloud.scans[2];
  std::fill(keep.begin() + gone.begin, keep.begin() + gone.end, false);
  filter(set, keep);

  ASSERT_EQ(set.cloud.scans.size(), 7u);
  ASSERT_EQ(set.poses.size(), 7u);
  EXPECT_EQ(set.cloud.size(), static_cast<size_t>(std::count(keep.begin(), keep.end(), true)));
  for (size_t k = 0; k < 7; ++k) {
    const size_t was = k < 2 ? k : k + 1;
    EXPECT_EQ(set.poses[k].origin, whole.poses[was].origin);
    const Scan &now = set.cloud.scans[k], &before = whole.cloud.scans[was];
    std::set<int32_t> used;
    for (size_t cell = 0; cell < now.range_grid->sample.size(); ++cell) {
      const int32_t s = now.range_grid->sample[cell];
      if (s < 0) continue;
      ASSERT_TRUE(used.insert(s).second);
      ASSERT_EQ(set.cloud.positions[now.begin + s],
                whole.cloud.positions[before.begin + before.range_grid->sample[cell]]);
    }
    EXPECT_EQ(used.size(), now.size());
  }
}

TEST(Missing, RefusalsNameTheValueAndItsConstraint) {
  const auto shape = make_sphere();
  const PointCloud cloud = sample_surface(*shape, 10, 1);
  const auto message = [&](const MissingParams& params) -> std::string {
    try {
      kept_samples(*shape, cloud, params, Context(1));
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({.hole = 0.95}), "hole = 0.95, must be in [0, 0.9]");
  EXPECT_EQ(message({.hole = NAN}), "hole = nan, must be in [0, 0.9]");
  EXPECT_EQ(message({.sparse_half = 0.5}), "sparse_half = 0.5, must be >= 1");
  EXPECT_THROW(kept_samples(*shape, {}, {.sparse_half = 2}, Context(1)), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
