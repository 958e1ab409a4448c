// Leica PTX: scans, their matrices, cells and columns, on files made here; real files when SOAPFILM_DATA names the
// data.
#include <fmt/format.h>

#include "files.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

const std::string identity = "1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";

/// The head of a scan without rotation whose scanner stands at `place`.
std::string head(int columns, int rows, const std::string& place = "0 0 0") {
  return fmt::format("{}\n{}\n{}\n{}{} 1\n", columns, rows, place, identity, place);
}

PointCloud read_text(const std::string& text, ReadReport* report = nullptr, const std::string& name = "a.ptx") {
  const TemporaryFolder folder;
  return read_points(folder.write(name, text), report);
}

void expect_refused(const std::string& text, std::initializer_list<std::string> parts) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.ptx", text);
  expect_refusal<InputError>([&] { read_points(path); }, parts);
  expect_refusal<InputError>([&] { read_points(path); }, {path});
}

TEST(Ptx, PointsAreRowVectorsOfTheMatrix) {
  // x to y, y to z, z to x, then the shift.
  const std::string turned = "0 1 0\n0 0 1\n1 0 0\n0 1 0 0\n0 0 1 0\n1 0 0 0\n10 20 30 1\n";
  const PointCloud cloud = read_text("1\n2\n10 20 30\n" + turned + "1 2 3\n4 5 6\n");
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{13, 21, 32}, {16, 24, 35}}));
  EXPECT_EQ(cloud.scans.at(0).sensor, (Vec3d{10, 20, 30}));
}

TEST(Ptx, TheMatrixCountsWhereAUsersSystemMovesTheScan) {
  const PointCloud cloud = read_text("1\n1\n7 7 7\n" + identity + "1 2 3 1\n1 1 1 0.5\n");
  EXPECT_EQ(cloud.scans.at(0).sensor, (Vec3d{1, 2, 3}));
  EXPECT_EQ(cloud.positions.at(0), (Vec3d{2, 3, 4}));
}

TEST(Ptx, CellsWithoutReturnAreDroppedAndTheGridKeepsTheirPlace) {
  ReadReport report;
  const PointCloud cloud =
      read_text(head(3, 2) + "1 0 5 0.25\n0 0 0 0.5\n2 0 5 1\n3 0 5 0\n0 0 0 0\n4 0 5 0.5\n", &report);
  EXPECT_EQ(cloud.size(), 4u);
  EXPECT_EQ(report.files.at(0).no_return, 2u);
  EXPECT_EQ(report.files[0].samples, 4u);
  EXPECT_EQ(report.files[0].dropped, 0u);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
  ASSERT_TRUE(cloud.scans.at(0).range_grid);
  EXPECT_EQ(cloud.scans[0].range_grid->columns, 3);
  EXPECT_EQ(cloud.scans[0].range_grid->rows, 2);
  // Columns of the file stand side by side: (first, second), (third, fourth), (fifth, sixth).
  EXPECT_EQ(cloud.scans[0].range_grid->sample, std::vector<int32_t>({0, 1, -1, -1, 2, 3}));
  ASSERT_EQ(cloud.columns.size(), 1u);
  EXPECT_EQ(cloud.columns[0].name, "intensity");
  EXPECT_EQ(cloud.columns[0].values, std::vector<float>({0.25f, 1, 0, 0.5f}));
}

TEST(Ptx, ASampleThatTheMatrixMovesToTheOriginIsKept) {
  ReadReport report;
  const PointCloud cloud = read_text(head(1, 3, "-1 -2 -3") + "1 2 3\n4 2 3\n0 0 0\n", &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{0, 0, 0}, {3, 0, 0}}));
  EXPECT_EQ(report.files.at(0).no_return, 1u);
}

TEST(Ptx, RowsWithoutReturnMayHaveFewerColumns) {
  ReadReport report;
  const PointCloud cloud = read_text(head(2, 2) + "0 0 0 0.5\n1 0 5 0.5 10 20 30\n0 0 0\n2 0 5 0.5 0 0 0\n", &report);
  EXPECT_EQ(cloud.size(), 2u);
  EXPECT_EQ(report.files.at(0).no_return, 2u);
  EXPECT_EQ(cloud.colors, std::vector<Rgb8>({{10, 20, 30}, {128, 128, 128}}));  // black is none
}

TEST(Ptx, ColorsThatAreAllBlackAreNone) {
  const PointCloud cloud = read_text(head(1, 2) + "1 0 5 0.5 0 0 0\n2 0 5 0.5 0 0 0\n");
  EXPECT_TRUE(cloud.colors.empty());
  EXPECT_EQ(cloud.columns.at(0).values, std::vector<float>({0.5f, 0.5f}));
}

TEST(Ptx, ScansFollowEachOtherAndKeepTheirOwnScanner) {
  const std::string text = head(2, 2, "100 0 0") + "1 0 5 0.5\n0 0 0 0\n2 0 5 0.5\n3 1 5 0.5\n\n" +
                           head(1, 3, "0 200 0") + "1 1 1\n2 2 2\n3 3 3\n" + head(1, 1, "0 0 9") + "0 0 0 0\n" +
                           head(2, 1, "0 0 300") + "1 1 1 0.5 1 2 3\n2 2 2 0.5 255 0 0";
  for (const bool windows : {false, true}) {
    std::string lines;
    for (const char c : text) lines += c == '\n' && windows ? "\r\n" : std::string(1, c);
    ReadReport report;
    const PointCloud cloud = read_text(lines, &report);
    ASSERT_EQ(cloud.scans.size(), 3u);  // that of one cell saw nothing
    EXPECT_EQ(report.files.at(0).no_return, 2u);
    EXPECT_EQ(cloud.scans[0].name, "a 1");
    EXPECT_EQ(cloud.scans[0].sensor, (Vec3d{100, 0, 0}));
    EXPECT_EQ(cloud.scans[1].sensor, (Vec3d{0, 200, 0}));
    EXPECT_EQ(cloud.scans[2].sensor, (Vec3d{0, 0, 300}));
    EXPECT_EQ(cloud.scans[1].begin, 3u);
    EXPECT_EQ(cloud.scans[1].end, 6u);
    EXPECT_EQ(cloud.positions[3], (Vec3d{1, 201, 1}));
    EXPECT_TRUE(cloud.scans[0].range_grid);
    EXPECT_FALSE(cloud.scans[1].range_grid || cloud.scans[2].range_grid);  // one column, one row: lists of points
    EXPECT_TRUE(std::isnan(cloud.columns.at(0).values[4]));
    EXPECT_EQ(cloud.colors[7], (Rgb8{255, 0, 0}));
    EXPECT_EQ(cloud.colors[0], (Rgb8{128, 128, 128}));
  }
}

TEST(Ptx, IsKnownByItsHeadUnderAnyName) {
  const std::string text = head(1, 2, "4 5 6") + "1 0 5 0.5\n2 0 5 0.5\n";
  for (const char* name : {"scan.txt", "scan.pts", "scan.xyz", "scan"}) {
    const PointCloud cloud = read_text(text, nullptr, name);
    EXPECT_EQ(cloud.size(), 2u) << name;
    EXPECT_TRUE(cloud.scans.at(0).sensor) << name;
  }
  EXPECT_EQ(read_text("2\n1 2 3\n4 5 6\n", nullptr, "list.pts").size(), 2u);  // a count and its points: no PTX
}

/// A scan of heights over a map from (x, y) on, as converters of other formats write it.
std::string map_scan(int columns, int rows, double x, double y, const std::string& place = "0 0 0") {
  std::string text = head(columns, rows, place);
  for (int i = 0; i < columns * rows; ++i) {
    const double px = x + i / 40, py = y + i % 40;
    text += fmt::format("{:.3f} {:.3f} {:.3f} 0.5\n", px, py, 3 * std::sin(px / 7) * std::cos(py / 9) - 1.5);
  }
  return text;
}

TEST(Ptx, ADefaultMatrixIsAScannersOnlyIfTheSamplesWereSeenFromThere) {
  const auto places = [](const std::string& text, size_t warnings) {
    ReadReport report;
    const PointCloud cloud = read_text(text, &report);
    EXPECT_EQ(report.warnings.size(), warnings);
    std::vector<bool> has;
    for (const Scan& scan : cloud.scans) has.push_back(scan.sensor.has_value());
    return has;
  };
  EXPECT_EQ(places(map_scan(1600, 1, 5e5, 4.1e6), 1), std::vector<bool>{false});
  EXPECT_EQ(places(map_scan(1600, 1, -20, -20), 1), std::vector<bool>{false});
  EXPECT_EQ(places(map_scan(40, 40, -20, -20), 1), std::vector<bool>{false});
  EXPECT_EQ(places(map_scan(40, 40, -20, -20, "500000 4100000 0"), 1), std::vector<bool>{false});
  EXPECT_EQ(places(map_scan(40, 40, 5e5, 4.1e6) + map_scan(3, 2, 10, 10, "1 2 3"), 1),
            (std::vector<bool>{false, true}));
  std::string scan = head(60, 30);
  for (int c = 0; c < 60; ++c)
    for (int r = 0; r < 30; ++r) {
      const double azimuth = c * 0.1, height = 1 - r * 0.06, range = 5 + std::sin(c / 3) + 0.3 * std::cos(r / 4);
      scan += fmt::format("{:.4f} {:.4f} {:.4f} 0.5\n", range * std::cos(height) * std::cos(azimuth),
                          range * std::cos(height) * std::sin(azimuth), range * std::sin(height));
    }
  EXPECT_EQ(places(scan, 0), std::vector<bool>{true});
  const TemporaryFolder folder;
  ReadOptions trusting;
  trusting.trust_viewpoint = true;
  EXPECT_TRUE(
      read_points(folder.write("a.ptx", map_scan(40, 40, -20, -20)), nullptr, Context(1), trusting).scans.at(0).sensor);
}

TEST(Ptx, MatricesThatScaleOneAxisAreUsedAndNamed) {
  const auto scaled = [](const char* x, const char* y, const char* z) {
    ReadReport report;
    const TemporaryFolder folder;
    const PointCloud cloud =
        read_points(folder.write("m.ptx", fmt::format("1\n1\n5 0 0\n1 0 0\n0 1 0\n0 0 1\n{0} 0 0 0\n0 {1} 0 0\n0 0 {2} "
                                                      "0\n5 0 0 1\n1 1 1\n",
                                                      x, y, z)),
                    &report);
    return std::pair(cloud.positions.at(0), report.warnings);
  };
  EXPECT_EQ(scaled("1", "1", "2").first, (Vec3d{6, 1, 2}));
  ASSERT_EQ(scaled("1", "1", "2").second.size(), 1u);
  EXPECT_NE(scaled("1", "1", "2").second[0].find("1, 1 and 2"), std::string::npos);
  EXPECT_NE(scaled("1", "1", "-1").second.at(0).find("mirrors"), std::string::npos);
  EXPECT_EQ(scaled("0.001", "0.001", "0.001").second, std::vector<std::string>());  // another unit
}

TEST(Ptx, Refusals) {
  expect_refused(head(2, 2) + "1 0 5\n2 0 5\n3 0 5\n", {"a.ptx:1:", "2 x 2", "truncated"});
  expect_refused(head(2, 2) + "1.000 0 5\n2.000000000 0 5\n3 0 5\n", {"a.ptx:13:", "truncated", "3 of 4 cells"});
  expect_refused(head(1, 1) + "1 0 5\n" + head(1, 2) + "1.0000000000 0 5\n", {"truncated", "scan 2"});
  expect_refused(head(1, 1) + "1 0 5\n3\n", {"truncated", "scan 2", "rows"});
  expect_refused(head(2000000000, 2000000000) + "1 0 5\n", {"a.ptx:1:", "2000000000 x 2000000000", "truncated"});
  expect_refused(head(1, 2) + "1 0 5 0.5\n1 0 5\n", {"a.ptx:12:", "3 numbers", "must be 4"});
  expect_refused(head(1, 1) + "1 0 5 0.5 7\n", {"a.ptx:11:", "5 numbers", "3 (x y z)"});
  expect_refused(head(1, 1) + "1 0 5 0.5 7 7 7 7\n", {"a.ptx:11:", "more than 7"});
  expect_refused(head(1, 1) + "1 zero 5\n", {"a.ptx:11:", "column 2", "'zero'"});
  expect_refused(head(1, 2) + "0 0 0\n0 0 0\n", {"none of its 2 samples", "2 no return"});
  expect_refused("0\n2\n" + head(1, 1), {"a.ptx:1:", "columns = '0'"});
  expect_refused("2\n2 2\n" + head(1, 1), {"a.ptx:2:", "rows = '2 2'"});
  const std::string axes = "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  expect_refused(axes + "1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n1 0 5\n", {"a.ptx:10:", "singular"});
  expect_refused(axes + "1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n1 0 5\n", {"a.ptx:7:", "ends with 5", "last row"});
  expect_refused(axes + "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 0\n1 0 5\n", {"a.ptx:10:", "ends with 0", "must be 1"});
  expect_refused(axes + "1 0 0 0\n0 nan 0 0\n0 0 1 0\n0 0 0 1\n1 0 5\n", {"a.ptx:8:", "finite"});
}

TEST(Ptx, EveryCutOfAFileIsRefusedOrHasWholeScans) {
  const std::string text = head(1, 2, "1 2 3") + "1 0 5 0.5\n2 0 5 0.5\n" + head(2, 1) + "3 0 5 0.5\n4 0 5 0.25\n";
  const size_t first = (head(1, 2, "1 2 3") + "1 0 5 0.5\n2 0 5 0.5").size();
  const TemporaryFolder folder;
  for (size_t length = 1; length < text.size(); ++length) {
    const std::string path = folder.write("cut.ptx", text.substr(0, length));
    try {
      const size_t samples = read_points(path).size();
      // Digits may be missing at the very end.
      EXPECT_TRUE((samples == 2 && length + 10 > first && length <= first + 1) ||
                  (samples == 4 && length + 5 > text.size()))
          << length;
    } catch (const InputError&) {
    }
  }
}

void expect_box(const PointCloud& cloud, Vec3d lo, Vec3d hi, double tolerance) {
  const Box3d box = cloud.box();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.lo[axis], lo[axis], tolerance);
    EXPECT_NEAR(box.hi[axis], hi[axis], tolerance);
  }
}

TEST(Ptx, RealFiles) {
  const auto two = real_data("formats/ptx-two-scans-poses.ptx");
  const auto one = real_data("formats/ptx-no-color.ptx");
  if (!two || !one) GTEST_SKIP() << "no formats in SOAPFILM_DATA";
  const PointCloud cloud = read_points(*two);
  ASSERT_EQ(cloud.scans.size(), 2u);
  EXPECT_EQ(cloud.size(), 8u);
  EXPECT_EQ(cloud.scans[0].sensor, (Vec3d{600000, 800000, 400}));
  EXPECT_FALSE(cloud.scans[1].sensor);  // the identity, and coordinates of a map
  EXPECT_TRUE(cloud.scans[0].range_grid);
  expect_box(cloud, {636699.38, 848991.01, 425.39}, {637012.24, 849106.66, 446.39}, 1e-6);
  for (size_t i = 0; i < 4; ++i) EXPECT_LT(norm(cloud.positions[i] - cloud.positions[4 + i]), 1e-6);
  const PointCloud plain = read_points(*one);
  EXPECT_EQ(plain.size(), 15u);
  expect_box(plain, {635795.24, 848991.01, 408.60}, {637012.24, 849390.78, 446.39}, 1e-6);
  EXPECT_EQ(plain.columns.at(0).name, "intensity");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
