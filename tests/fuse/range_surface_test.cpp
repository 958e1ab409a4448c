#include "soapfilm/fuse/range_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

#include "soapfilm/error.h"

namespace soapfilm {
namespace TEST_FILE {

/// A scan along -z of the heights z(x, y) on a raster of unit steps; not-a-number: nothing seen.
PointCloud scan_of(int columns, int rows, const std::function<double(int x, int y)>& height) {
  PointCloud cloud;
  RangeGrid grid{columns, rows, {}};
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const double z = height(x, y);
      grid.sample.push_back(std::isnan(z) ? -1 : static_cast<int32_t>(cloud.size()));
      if (!std::isnan(z)) cloud.positions.push_back({static_cast<double>(x), static_cast<double>(y), z});
    }
  }
  cloud.scans.push_back({"a scan", 0, cloud.size(), {}, Vec3d{0, 0, 1}, std::move(grid)});
  return cloud;
}

RangeSurface surface_of(const PointCloud& cloud, const RangeSurfaceParams& params = {}) {
  return range_surface(cloud, cloud.scans[0], params);
}

double flat(int, int) { return 0; }

Vec3d normal_of(const PointCloud& cloud, const Triangle& t) {
  const Vec3d a = cloud.positions[t[0]];
  return normalized(cross(cloud.positions[t[1]] - a, cloud.positions[t[2]] - a));
}

TEST(RangeSurface, FourPixelsGiveTwoTrianglesAlongTheShorterDiagonal) {
  for (const double lift : {-1.0, 1.0}) {
    // Corner 0 leaves the plane of the others, so that the diagonal through it is the longer one.
    const PointCloud cloud = scan_of(2, 2, [&](int x, int y) { return x == 0 && y == 0 ? lift : 0; });
    const RangeSurface surface = surface_of(cloud);
    ASSERT_EQ(surface.triangles.size(), 2u);
    for (const Triangle& t : surface.triangles) {
      const std::set<uint32_t> corners(t.begin(), t.end());
      EXPECT_TRUE(corners.count(1) && corners.count(2));
    }
  }
}

TEST(RangeSurface, ThreePixelsGiveOneTriangleAndTwoGiveNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int gap = 0; gap < 4; ++gap) {
    const PointCloud cloud = scan_of(2, 2, [&](int x, int y) { return x + 2 * y == gap ? nan : 0; });
    ASSERT_EQ(surface_of(cloud).triangles.size(), 1u);
    EXPECT_GT(normal_of(cloud, surface_of(cloud).triangles[0]).z, 0);
  }
  EXPECT_TRUE(surface_of(scan_of(2, 2, [&](int x, int) { return x == 0 ? nan : 0; })).triangles.empty());
}

TEST(RangeSurface, TrianglesTurnTowardsTheScannerWhicheverWayTheGridRuns) {
  PointCloud cloud = scan_of(5, 4, [](int x, int y) { return 0.3 * x - 0.2 * y; });
  for (const bool mirrored : {false, true}) {
    if (mirrored)
      for (Vec3d& p : cloud.positions) p.x = -p.x;
    const RangeSurface surface = surface_of(cloud);
    EXPECT_EQ(surface.triangles.size(), 24u);
    EXPECT_EQ(surface.dropped, 0u);
    for (const Triangle& t : surface.triangles) EXPECT_GT(normal_of(cloud, t).z, 0);
  }
}

TEST(RangeSurface, StepsInDepthAreNotBridged) {
  // Eight triangles lie across the step, 75.3 degrees steep, their diagonals 4.05 samples long.
  const PointCloud cloud = scan_of(6, 5, [](int x, int) { return x < 3 ? 0 : 3.8; });
  const auto dropped = [&](double max_edge, double max_incidence_deg) {
    RangeSurfaceParams params;
    params.max_edge = max_edge;
    params.max_incidence_deg = max_incidence_deg;
    const RangeSurface surface = surface_of(cloud, params);
    EXPECT_EQ(surface.triangles.size() + surface.dropped, 40u);
    return surface.dropped;
  };
  EXPECT_EQ(dropped(4.1, 75.5), 0u);
  EXPECT_EQ(dropped(4.0, 75.5), 8u);
  EXPECT_EQ(dropped(4.1, 75.0), 8u);
  for (const Triangle& t : surface_of(cloud).triangles) EXPECT_NEAR(normal_of(cloud, t).z, 1, 1e-12);
}

TEST(RangeSurface, TrianglesThatShowTheirBackAreDropped) {
  PointCloud cloud = scan_of(6, 5, flat);
  for (Vec3d& p : cloud.positions)
    if (p.x == 4) p.x = 2.5;  // folded over
  const RangeSurface surface = surface_of(cloud);
  for (const Triangle& t : surface.triangles) EXPECT_GT(normal_of(cloud, t).z, 0);
  EXPECT_EQ(surface.dropped, 8u);
}

TEST(RangeSurface, WeightIsTheCosineTimesTheSamplesOwnAndTapersTowardsTheBorder) {
  const double slope = std::tan(50 * std::numbers::pi / 180);
  PointCloud cloud = scan_of(21, 15, [&](int x, int) { return slope * x; });
  const double cosine = std::cos(50 * std::numbers::pi / 180);
  const RangeSurface surface = surface_of(cloud);
  const auto at = [](int x, int y) { return static_cast<size_t>(x + 21 * y); };
  for (int y = 0; y < 15; ++y) {
    for (int x = 0; x < 21; ++x) {
      const int steps = std::min({x, 20 - x, y, 14 - y, 4});
      const double weight = surface.weight[at(x, y)] / cosine;
      // A diagonal is one step as well, so the count of steps is that of the nearest side.
      EXPECT_NEAR(weight, (steps + 1) / 5.0, 1e-6) << x << " " << y;
    }
  }
  RangeSurfaceParams untapered;
  untapered.taper = 0;
  for (const float w : surface_of(cloud, untapered).weight) EXPECT_NEAR(w, cosine, 1e-6);
  cloud.weights.assign(cloud.size(), 1);
  cloud.weights[at(7, 7)] = 2.5;
  EXPECT_NEAR(surface_of(cloud).weight[at(7, 7)], 2.5 * cosine, 1e-6);
}

TEST(RangeSurface, SamplesWithoutATriangleHaveNoWeight) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const PointCloud cloud = scan_of(8, 4, [&](int x, int y) { return x == 7 && y == 0 ? 0 : x < 5 ? 0 : nan; });
  EXPECT_EQ(surface_of(cloud).weight[5], 0);
}

TEST(RangeSurface, CosineIsThatOfTheRayToASensor) {
  PointCloud cloud = scan_of(21, 21, flat);
  cloud.scans[0].view_direction.reset();
  cloud.scans[0].sensor = Vec3d{10, 10, 10};
  const RangeSurface surface = surface_of(cloud);
  EXPECT_NEAR(surface.weight[10 + 21 * 10], 1, 1e-6);
  EXPECT_NEAR(surface.weight[15 + 21 * 10], 10 / std::hypot(10, 5), 1e-6);
}

template <class Change>
std::string refusal(Change&& change) {
  PointCloud cloud = scan_of(3, 3, flat);
  RangeSurfaceParams params;
  change(cloud.scans[0], params);
  try {
    surface_of(cloud, params);
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RangeSurface, RefusesWhatIsNoRangeScan) {
  EXPECT_EQ(refusal([](Scan& s, auto&) { s.range_grid.reset(); }),
            "vrip needs range scans: scan \"a scan\" has no range grid");
  EXPECT_EQ(refusal([](Scan& s, auto&) { s.view_direction.reset(); }),
            "vrip needs range scans: scan \"a scan\" has no sensor position and no viewing direction");
  EXPECT_EQ(refusal([](Scan& s, auto&) { s.view_direction = Vec3d{}; }),
            "scan \"a scan\": viewing direction must be finite, not zero");
  EXPECT_EQ(refusal([](Scan& s, auto&) { s.range_grid->sample.pop_back(); }),
            "scan \"a scan\": range grid of 8 cells, must be columns * rows = 9");
  EXPECT_EQ(refusal([](Scan& s, auto&) { s.range_grid->sample[4] = 9; }),
            "scan \"a scan\": range grid names sample 9, must be < 9");
  EXPECT_EQ(refusal([](Scan&, auto& p) { p.max_edge = 1; }), "max_edge = 1, must be > 1 (distances between samples)");
  EXPECT_EQ(refusal([](Scan&, auto& p) { p.max_incidence_deg = 90; }),
            "max_incidence_deg = 90, must be > 0 and < 90 degrees");
  EXPECT_EQ(refusal([](Scan&, auto& p) { p.taper = -1; }), "taper = -1, must be >= 0 samples");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
