#include "tools/scanner/virtual_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "soapfilm/error.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

ScannerParams small() {
  ScannerParams params;
  params.views = 6;
  params.columns = 90;
  params.rows = 70;
  return params;
}

bool same(const ScanSet& a, const ScanSet& b) {
  if (a.cloud.positions != b.cloud.positions || a.cloud.normals != b.cloud.normals) return false;
  if (a.cloud.scans.size() != b.cloud.scans.size() || a.poses.size() != b.poses.size()) return false;
  for (size_t k = 0; k < a.poses.size(); ++k) {
    const Scan &s = a.cloud.scans[k], &t = b.cloud.scans[k];
    if (s.begin != t.begin || s.end != t.end || s.sensor != t.sensor || s.view_direction != t.view_direction ||
        s.range_grid->sample != t.range_grid->sample)
      return false;
    if (a.poses[k].origin != b.poses[k].origin || a.poses[k].x != b.poses[k].x) return false;
  }
  return true;
}

class EveryShapeScanned : public testing::TestWithParam<std::string> {};

TEST_P(EveryShapeScanned, CleanSamplesLieOnTheShape) {
  const auto shape = make_shape(GetParam());
  for (const Rays rays : {Rays::central, Rays::parallel}) {
    ScannerParams params = small();
    params.rays = rays;
    params.normals = true;
    const ScanSet set = virtual_scan(*shape, params, Context(2));
    ASSERT_EQ(set.cloud.scans.size(), 6u);
    ASSERT_GT(set.cloud.size(), 2000u);
    for (size_t k = 0; k < 6; ++k) {
      const Scan& scan = set.cloud.scans[k];
      ASSERT_EQ(scan.sensor.has_value(), rays == Rays::central);
      ASSERT_EQ(scan.view_direction.has_value(), rays == Rays::parallel);
      for (size_t i = scan.begin; i < scan.end; ++i) {
        const Vec3d p = set.cloud.positions[i];
        ASSERT_LE(shape->distance(p), 1e-9 * shape->box().longest());
        const Vec3d towards = scan.sensor ? normalized(*scan.sensor - p) : *scan.view_direction;
        ASSERT_GE(dot(static_cast<Vec3d>(set.cloud.normals[i]), towards), std::cos(80.01 / 57.29577951308232));
      }
    }
  }
}

TEST_P(EveryShapeScanned, TheDefaultOrbitSeesAllOfIt) {
  const auto shape = make_shape(GetParam());
  const ScannerParams params;
  const std::vector<Vec3d> scanners = scanner_positions(shape->box(), params);
  const PointCloud truth = sample_surface(*shape, 2000, 1);
  const double least_cosine = std::cos(params.max_incidence_deg / 57.29577951308232);
  size_t seen = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    const auto normal = static_cast<Vec3d>(truth.normals[i]);
    const Vec3d above = truth.positions[i] + normal * 1e-6;
    seen += std::any_of(scanners.begin(), scanners.end(), [&](Vec3d scanner) {
      const Vec3d direction = normalized(scanner - above);
      return dot(direction, normal) > least_cosine && !shape->intersect(above, direction);
    });
  }
  EXPECT_GE(seen, truth.size() * 999 / 1000);
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShapeScanned, testing::ValuesIn(shape_names()),
                         [](const auto& each) { return each.param; });

TEST(VirtualScan, RangeGridHoldsEachSampleOnceAndAtItsRay) {
  const auto shape = make_part();
  for (const Rays rays : {Rays::central, Rays::parallel}) {
    ScannerParams params = small();
    params.rays = rays;
    params.noise = 1e-3;
    const ScanSet set = virtual_scan(*shape, params, Context(2));
    for (size_t k = 0; k < set.cloud.scans.size(); ++k) {
      const Scan& scan = set.cloud.scans[k];
      ASSERT_EQ(scan.range_grid->columns, 90);
      ASSERT_EQ(scan.range_grid->rows, 70);
      std::set<int32_t> used;
      double step = 0.0;
      for (int row = 0; row < 70; ++row) {
        for (int column = 0; column < 90; ++column) {
          const int32_t s = scan.range_grid->sample[static_cast<size_t>(row) * 90 + column];
          if (s < 0) continue;
          ASSERT_LT(static_cast<size_t>(s), scan.size());
          ASSERT_TRUE(used.insert(s).second);
          const Vec3d local = set.poses[k].to_local(set.cloud.positions[scan.begin + s]);
          ASSERT_LT(local.z, 0.0);  // in front of the scanner
          const double scale = rays == Rays::central ? 1.0 / -local.z : 1.0;
          // The image is linear in the pixel's offset from its middle; the second row of pixels sets the step.
          const double dx = column - 44.5, dy = 34.5 - row;
          if (step == 0.0) step = local.x * scale / dx;
          ASSERT_NEAR(local.x * scale, dx * step, 1e-12);
          ASSERT_NEAR(local.y * scale, dy * step, 1e-12);
        }
      }
      EXPECT_EQ(used.size(), scan.size());
    }
  }
}

TEST(VirtualScan, IsTheSameForAnyNumberOfThreads) {
  const auto shape = make_torus();
  ScannerParams params = small();
  params.noise = 1e-3;
  params.outliers = 0.05;
  params.drop_out = 0.1;
  params.misalignment = 1e-3;
  params.misalignment_deg = 0.3;
  params.normals = true;
  const ScanSet one = virtual_scan(*shape, params, Context(1));
  for (const int threads : {2, 3, 8}) EXPECT_TRUE(same(one, virtual_scan(*shape, params, Context(threads))));
  params.seed = 2;
  EXPECT_FALSE(same(one, virtual_scan(*shape, params, Context(2))));
}

TEST(VirtualScan, NoiseIsGaussianAlongTheRay) {
  const auto shape = make_sphere();
  ScannerParams params = small();
  params.columns = params.rows = 150;
  const ScanSet clean = virtual_scan(*shape, params, Context(2));
  params.noise = 0.01;
  const ScanSet noisy = virtual_scan(*shape, params, Context(2));
  ASSERT_EQ(clean.cloud.size(), noisy.cloud.size());
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (const Scan& scan : clean.cloud.scans) {
    for (size_t i = scan.begin; i < scan.end; ++i) {
      const Vec3d shift = noisy.cloud.positions[i] - clean.cloud.positions[i];
      const Vec3d ray = normalized(clean.cloud.positions[i] - *scan.sensor);
      const double along = dot(shift, ray);
      ASSERT_LE(norm(shift - ray * along), 1e-14);
      sum += along;
      squares += along * along;
      fourth += along * along * along * along;
    }
  }
  const auto n = static_cast<double>(clean.cloud.size());
  EXPECT_NEAR(sum / n, 0.0, 4.0 * 0.01 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.01, 4.0 * 0.01 / std::sqrt(2.0 * n));
  EXPECT_NEAR(fourth * n / (squares * squares), 3.0, 4.0 * std::sqrt(24.0 / n));
}

TEST(VirtualScan, OutliersAndDropOutHaveTheirShares) {
  const auto shape = make_sphere();
  ScannerParams params = small();
  params.columns = params.rows = 150;
  const auto clean = static_cast<double>(virtual_scan(*shape, params, Context(2)).cloud.size());

  params.drop_out = 0.3;
  const auto kept = static_cast<double>(virtual_scan(*shape, params, Context(2)).cloud.size());
  EXPECT_NEAR(kept / clean, 0.7, 4.0 * std::sqrt(0.21 / clean));

  params.drop_out = 0.0;
  params.outliers = 0.1;
  for (const Outliers kind : {Outliers::ray, Outliers::box}) {
    params.outlier_kind = kind;
    const ScanSet set = virtual_scan(*shape, params, Context(2));
    ASSERT_EQ(static_cast<double>(set.cloud.size()), clean);
    double off = 0.0, in_grid = 0.0;
    for (const Vec3d& p : set.cloud.positions) off += shape->distance(p) > 1e-9;
    for (const Scan& scan : set.cloud.scans)
      in_grid += static_cast<double>(std::count_if(scan.range_grid->sample.begin(), scan.range_grid->sample.end(),
                                                   [](int32_t s) { return s >= 0; }));
    EXPECT_NEAR(off / clean, 0.1, 4.0 * std::sqrt(0.09 / clean));
    EXPECT_EQ(in_grid, kind == Outliers::ray ? clean : clean - off);
  }
}

TEST(VirtualScan, GrazingHitsAreLost) {
  const auto shape = make_sphere();
  ScannerParams params = small();
  params.normals = true;
  params.max_incidence_deg = 40;
  const ScanSet set = virtual_scan(*shape, params, Context(2));
  for (const Scan& scan : set.cloud.scans) {
    double least = 1.0;
    for (size_t i = scan.begin; i < scan.end; ++i) {
      const Vec3d towards = normalized(*scan.sensor - set.cloud.positions[i]);
      least = std::min(least, dot(towards, static_cast<Vec3d>(set.cloud.normals[i])));
    }
    EXPECT_NEAR(least, std::cos(40 / 57.29577951308232), 0.03);
    EXPECT_GE(least, std::cos(40.001 / 57.29577951308232));
  }
}

TEST(VirtualScan, MisalignmentIsARigidMotionOfEachScanAndItsPose) {
  const auto shape = make_part();
  ScannerParams params = small();
  params.views = 40;
  params.columns = params.rows = 40;
  params.normals = true;
  const ScanSet clean = virtual_scan(*shape, params, Context(2));
  params.misalignment = 0.01;
  params.misalignment_deg = 2.0;
  const ScanSet moved = virtual_scan(*shape, params, Context(2));
  ASSERT_EQ(moved.cloud.size(), clean.cloud.size());
  double shift = 0.0, angle = 0.0;
  for (size_t k = 0; k < clean.poses.size(); ++k) {
    const Scan& scan = clean.cloud.scans[k];
    const Pose &a = clean.poses[k], &b = moved.poses[k];
    EXPECT_EQ(*moved.cloud.scans[k].sensor, b.origin);
    Vec3d mean_a, mean_b;
    for (size_t i = scan.begin; i < scan.end; ++i) {
      // In its own frame the scan is what it was: only the registration is wrong.
      ASSERT_LE(norm(a.to_local(clean.cloud.positions[i]) - b.to_local(moved.cloud.positions[i])), 1e-13);
      mean_a += clean.cloud.positions[i] / static_cast<double>(scan.size());
      mean_b += moved.cloud.positions[i] / static_cast<double>(scan.size());
    }
    shift += dot(mean_b - mean_a, mean_b - mean_a);
    const double cosine = 0.5 * (dot(a.x, b.x) + dot(a.y, b.y) + dot(a.z, b.z) - 1.0);
    angle += std::pow(std::acos(std::clamp(cosine, -1.0, 1.0)) * 57.29577951308232, 2);
  }
  const auto n = static_cast<double>(clean.poses.size());
  EXPECT_NEAR(std::sqrt(shift / (3.0 * n)), 0.01, 0.003);
  EXPECT_NEAR(std::sqrt(angle / n), 2.0, 0.6);
}

TEST(VirtualScan, StepGivesEvenSpacingAtTheTarget) {
  const auto shape = make_plate();
  ScannerParams params;
  params.rays = Rays::parallel;
  params.positions = {{0.0, 0.0, 3.0}};
  params.step = 0.01;
  const ScanSet set = virtual_scan(*shape, params, Context(1));
  const RangeGrid& grid = *set.cloud.scans[0].range_grid;
  EXPECT_EQ(std::max(grid.columns, grid.rows), 101);
  EXPECT_EQ(std::min(grid.columns, grid.rows), 71);
  // The flat top, seen straight on: every second sample has a neighbor at the step.
  EXPECT_NEAR(norm(set.cloud.positions[3001] - set.cloud.positions[3000]), 0.01, 1e-12);
}

TEST(VirtualScan, PositionsFollowOrbitElevationAndTarget) {
  const Box3d box{{-1, -1, -1}, {1, 1, 1}};
  ScannerParams params;
  params.orbit = Orbit::ring;
  params.views = 4;
  params.elevations_deg = {0, 45};
  params.distance = 2.0;
  params.target = Vec3d{10.0, 0.0, 0.0};
  const std::vector<Vec3d> ring = scanner_positions(box, params);
  ASSERT_EQ(ring.size(), 8u);
  for (size_t k = 0; k < 8; ++k) {
    EXPECT_NEAR(norm(ring[k] - *params.target), 2.0 * box.diagonal(), 1e-12);
    EXPECT_NEAR(ring[k].z, k < 4 ? 0.0 : 2.0 * box.diagonal() * std::sqrt(0.5), 1e-12);
  }
  params.orbit = Orbit::fibonacci;
  params.views = 200;
  Vec3d mean;
  for (const Vec3d& p : scanner_positions(box, params)) mean += (p - *params.target) / 200.0;
  EXPECT_LE(norm(mean), 0.01 * box.diagonal());
}

TEST(VirtualScan, StanfordQuaternionGivesThePoseBack) {
  const auto shape = make_sphere();
  ScannerParams params = small();
  params.views = 50;
  params.columns = params.rows = 8;
  params.misalignment_deg = 30.0;
  for (const Pose& pose : virtual_scan(*shape, params, Context(1)).poses) {
    const auto [x, y, z, w] = pose.stanford_quaternion();
    // Textbook matrix of (x, y, z, w); its transpose takes the scan to the world, so its rows are the pose's axes.
    const Vec3d rows[3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    EXPECT_LE(norm(rows[0] - pose.x) + norm(rows[1] - pose.y) + norm(rows[2] - pose.z), 1e-14);
  }
}

TEST(VirtualScan, RefusalsNameTheValueAndItsConstraint) {
  const auto shape = make_sphere();
  const auto message = [&](auto change) -> std::string {
    ScannerParams params = small();
    change(params);
    try {
      virtual_scan(*shape, params, Context(1));
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message([](auto& p) { p.views = 0; }), "views = 0, must be in [1, 10000]");
  EXPECT_EQ(message([](auto& p) { p.distance = 0.5; }), "distance = 0.5, must be in (0.5, 1000] diagonals of the box");
  EXPECT_EQ(message([](auto& p) { p.elevations_deg = {95}; }), "elevation = 95, must be in [-90, 90] degrees");
  EXPECT_EQ(message([](auto& p) { p.columns = -3; }), "columns = -3, must be in [1, 20000]");
  EXPECT_EQ(message([](auto& p) { p.noise = -1; }), "noise = -1, must be >= 0");
  EXPECT_EQ(message([](auto& p) { p.noise = NAN; }), "noise = nan, must be >= 0");
  EXPECT_EQ(message([](auto& p) { p.outliers = 1.5; }), "outliers = 1.5, must be in [0, 1]");
  EXPECT_EQ(message([](auto& p) { p.drop_out = 1; }), "drop_out = 1, must be in [0, 1)");
  EXPECT_EQ(message([](auto& p) { p.max_incidence_deg = 0; }), "max_incidence_deg = 0, must be in (0, 90]");
  EXPECT_EQ(message([](auto& p) { p.misalignment = -2; }), "misalignment = -2, must be >= 0");
  EXPECT_NE(message([](auto& p) { p.step = 1e-9; }).find("step = 1e-09, must be larger"), std::string::npos);
  EXPECT_EQ(message([](auto& p) {
              p.positions = {{0, 0, 0}};
            }),
            "position: must differ from the target that the view looks at");
  EXPECT_EQ(message([](auto& p) {
              p.positions = {{0, 0, 9}};
              p.target = {0, 0, 20};
            }),
            "views: no ray of 1 range images met the surface; move the scanner or its target");
  EXPECT_EQ(message([](auto& p) {
              p.positions = {{0, 0, 0.1}};
            }),
            "views: no ray of 1 range images met the surface; move the scanner or its target");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
