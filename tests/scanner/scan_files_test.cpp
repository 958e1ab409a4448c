#include "tools/scanner/scan_files.h"

#include <gtest/gtest.h>

#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "support/process.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

class WrittenScans : public testing::TestWithParam<Rays> {};

TEST_P(WrittenScans, AreReadBackInTheWorldFrame) {
  ShapeParams shape;
  shape.center = {10.0, -20.0, 5.0};
  ScannerParams params;
  params.rays = GetParam();
  params.views = 5;
  params.columns = 40;
  params.rows = 30;
  params.normals = true;
  params.outliers = 0.1;
  params.outlier_kind = Outliers::box;
  params.misalignment = 0.01;
  params.misalignment_deg = 5.0;
  const ScanSet set = virtual_scan(*make_part(shape), params, Context(2));

  const test::TemporaryFolder folder;
  write_scans(folder.path().string(), "scans.conf", set, Context(1));
  const PointCloud back = read_points(folder.file("scans.conf"));

  ASSERT_EQ(back.size(), set.cloud.size());
  for (size_t i = 0; i < back.size(); ++i) {
    ASSERT_LE(norm(back.positions[i] - set.cloud.positions[i]), 1e-13);
    ASSERT_LE(norm(back.normals[i] - set.cloud.normals[i]), 1e-6f);
  }
  ASSERT_EQ(back.scans.size(), set.cloud.scans.size());
  for (size_t k = 0; k < back.scans.size(); ++k) {
    const Scan &a = back.scans[k], &b = set.cloud.scans[k];
    EXPECT_EQ(a.begin, b.begin);
    EXPECT_EQ(a.end, b.end);
    EXPECT_EQ(a.range_grid->columns, 40);
    EXPECT_EQ(a.range_grid->rows, 30);
    EXPECT_EQ(a.range_grid->sample, b.range_grid->sample);
    ASSERT_EQ(a.sensor.has_value(), b.sensor.has_value());
    ASSERT_EQ(a.view_direction.has_value(), b.view_direction.has_value());
    EXPECT_LE(norm(a.sensor.value_or(Vec3d{}) - b.sensor.value_or(Vec3d{})), 1e-13);
    EXPECT_LE(norm(a.view_direction.value_or(Vec3d{}) - b.view_direction.value_or(Vec3d{})), 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Rays, WrittenScans, testing::Values(Rays::central, Rays::parallel),
                         [](const auto& each) { return each.param == Rays::central ? "central" : "parallel"; });

TEST(WrittenScans, AFolderThatIsNotThereIsRefused) {
  ScannerParams params;
  params.views = 1;
  params.columns = params.rows = 10;
  const ScanSet set = virtual_scan(*make_sphere(), params, Context(1));
  EXPECT_THROW(write_scans("/no/such/folder", "scans.conf", set, Context(1)), OutputError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
