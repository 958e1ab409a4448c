// Sweeps of KITTI and nuScenes: rows of 32-bit numbers without a header.
#include "binary_bytes.h"
#include "files.h"
#include "soapfilm/core/random.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

/// Rows of a turning scanner: x y z intensity and, with five columns, ring.
std::string sweep(size_t rows, size_t columns, uint64_t seed = 1) {
  Random random(seed);
  std::string bytes;
  for (size_t i = 0; i < rows; ++i) {
    for (int axis = 0; axis < 3; ++axis) bytes += bytes_of(static_cast<float>(random.uniform(-40, 40)));
    bytes += bytes_of(static_cast<float>(columns == 5 ? std::floor(random.uniform(0, 255)) : random.uniform(0, 1)));
    if (columns == 5) bytes += bytes_of(static_cast<float>(i % 32));
  }
  return bytes;
}

TEST(Kitti, RowsAreSamplesSeenFromTheOrigin) {
  const TemporaryFolder folder;
  ReadReport report;
  const PointCloud cloud =
      read_points(folder.write("000042.bin", bytes_of<float>({1.5, 2.25, 3.125, 0.5, -2.5, 2.5, 0, 0.25})), &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{1.5, 2.25, 3.125}, {-2.5, 2.5, 0}}));
  ASSERT_EQ(cloud.columns.size(), 1u);
  EXPECT_EQ(cloud.columns[0].name, "intensity");
  EXPECT_EQ(cloud.columns[0].values, std::vector<float>({0.5, 0.25}));
  ASSERT_EQ(cloud.scans.size(), 1u);
  EXPECT_EQ(cloud.scans[0].name, "000042");
  EXPECT_EQ(cloud.scans[0].sensor, (Vec3d{0, 0, 0}));
  EXPECT_TRUE(report.warnings.empty());
}

TEST(Kitti, RowsAtTheScannerAreRaysWithoutReturn) {
  const TemporaryFolder folder;
  ReadReport report;
  EXPECT_EQ(read_points(folder.write("a.bin", bytes_of<float>({0, 0, 0, 0, 1, 2, 3, 0.5})), &report).size(), 1u);
  EXPECT_EQ(report.files.at(0).no_return, 1u);
  EXPECT_TRUE(report.warnings.empty());
}

TEST(Kitti, FiveColumnsWithRingsAreToldApart) {
  const TemporaryFolder folder;
  for (const size_t rows : {20u, 21u, 400u, 1023u}) {  // of some, both kinds of rows fit the size
    const PointCloud four = read_points(folder.write("a.bin", sweep(rows, 4)));
    EXPECT_EQ(four.size(), rows);
    EXPECT_EQ(four.columns.size(), 1u);
    for (const char* name : {"a.bin", "b.pcd.bin"}) {
      const PointCloud five = read_points(folder.write(name, sweep(rows, 5)));
      EXPECT_EQ(five.size(), rows);
      ASSERT_EQ(five.columns.size(), 2u);
      EXPECT_EQ(five.columns[1].name, "ring");
      EXPECT_TRUE(five.columns[1].is_label);
      EXPECT_EQ(five.columns[1].values[19], 19);
    }
  }
}

TEST(Kitti, OtherFilesOfTheNameAreRefused) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
    const std::string path = folder.write("r.bin", bytes);
    expect_refusal<InputError>([&] { read_points(path); }, parts);
    expect_refusal<InputError>([&] { read_points(path); }, {path});
  };
  refused(sweep(3, 4) + "abc", {"51 bytes", "multiple of 16"});
  refused("1.5 2 3\n4 5 6.25\n", {"is text"});
  refused(bytes_of<float>({1, 2, 3, 0, 1, 2e6, 3, 0}), {"byte 20", "y = 2000000", "1e6"});
  refused(bytes_of<float>({1, 2, 3, 0, 1, 2, std::nanf(""), 0}), {"byte 24", "z = nan"});
  refused(bytes_of<float>({1, 2, 3, std::numeric_limits<float>::infinity()}), {"byte 12", "intensity = inf", "finite"});
  refused(bytes_of<int32_t>({1, 2, 3, 4, 5, 6, 7, 8}), {"byte 0", "x ="});
  refused(bytes_of<double>({0.1, 0.2, 0.3, 0.4}), {"byte"});
  refused(std::string(160, '\0'), {"no return"});
}

}  // namespace TEST_FILE
}  // namespace soapfilm
