// E57: every coding, on files written here; real ones when SOAPFILM_DATA names the data.
#include "e57_files.h"
#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/crc32c.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

using test::doubles;
using test::E57TestField;
using test::E57TestOptions;
using test::E57TestScan;
using test::E57Writer;
using test::floats;
using test::integers;
using test::line_scan;
using test::pose_xml;
using test::read_e57_file;

const Column* column_of(const PointCloud& cloud, const std::string& name) {
  for (const Column& column : cloud.columns)
    if (column.name == name) return &column;
  return nullptr;
}

TEST(Crc32c, IsThatOfTheStandard) {
  EXPECT_EQ(io::crc32c("123456789", 9), 0xe3069283u);
  EXPECT_EQ(io::crc32c("", 0), 0u);
  const std::string zeros(32, '\0');  // RFC 3720, B.4
  EXPECT_EQ(io::crc32c(zeros.data(), zeros.size()), 0x8a9136aau);
}

TEST(E57, IntegersOfEveryWidthComeBackFromPacketsSplitAnywhere) {
  Random random(5);
  for (int bits = 0; bits <= 64; ++bits) {
    const uint64_t span = bits == 64 ? UINT64_MAX : (uint64_t{1} << bits) - 1;
    const int64_t minimum = bits >= 63 ? INT64_MIN : bits % 2 == 0 ? -static_cast<int64_t>(span / 3) : 17;
    const auto maximum = static_cast<int64_t>(static_cast<uint64_t>(minimum) + span);
    E57TestScan scan;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"}) {
      std::vector<int64_t> values{minimum, maximum};
      for (int i = 0; i < 200; ++i) {
        const uint64_t raw = (static_cast<uint64_t>(random.uniform() * 4294967296.0) << 32 |
                              static_cast<uint64_t>(random.uniform() * 4294967296.0)) &
                             span;
        values.push_back(static_cast<int64_t>(static_cast<uint64_t>(minimum) + raw));
      }
      scan.fields.push_back(integers(name, values, minimum, maximum, "scale=\"0.25\" offset=\"-3\""));
    }
    E57TestOptions options;
    options.other_packets = true;
    options.split = [&](size_t, size_t) { return static_cast<size_t>(random.uniform() * 40); };
    const PointCloud cloud = read_e57_file({scan}, nullptr, options);
    ASSERT_EQ(cloud.size(), 202u) << bits;
    for (size_t i = 0; i < cloud.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_EQ(cloud.positions[i][axis],
                  static_cast<double>(scan.fields[static_cast<size_t>(axis)].integers[i]) * 0.25 - 3)
            << bits << " bits, record " << i;
  }
}

TEST(E57, IntegersWithoutBoundsHave64Bits) {
  E57TestScan scan{{integers("cartesianX", {5, INT64_MIN, INT64_MAX}, std::nullopt, std::nullopt),
                    integers("cartesianY", {-7, 1, 2}, std::nullopt, 100),
                    integers("cartesianZ", {9, 1, 2}, 0, std::nullopt)}};
  const PointCloud cloud = read_e57_file({scan});
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(cloud.positions[0], (Vec3d{5, -7, 9}));
  EXPECT_EQ(cloud.positions[1].x, -0x1p63);
}

TEST(E57, FloatsOfBothSizesComeBackAndStreamsMayRunAhead) {
  std::vector<double> x, y, z;
  for (int i = 0; i < 3000; ++i) x.push_back(i / 3.0), y.push_back(-i * 0.5), z.push_back(1e6 + i / 7.0);
  E57TestOptions options;  // x comes first, whole, then y, then z a byte at a time
  options.split = [](size_t packet, size_t stream) -> size_t {
    if (stream == 2) return packet < 2 ? 0 : packet % 2 == 0 ? 1 : 60000;
    return packet == stream ? 60000 : 0;
  };
  const PointCloud cloud = read_e57_file(
      {{{doubles("cartesianX", x), floats("cartesianY", y), doubles("cartesianZ", z)}}}, nullptr, options);
  ASSERT_EQ(cloud.size(), 3000u);
  for (size_t i = 0; i < cloud.size(); ++i) ASSERT_EQ(cloud.positions[i], (Vec3d{x[i], y[i], z[i]}));
}

TEST(E57, ConstantFieldsTakeNoBits) {
  const PointCloud cloud =
      read_e57_file({line_scan(3, {integers("classification", {6, 6, 6}, 6, 6), integers("kind", {1, 2, 3}, 1, 3)})});
  EXPECT_EQ(column_of(cloud, "classification")->values, std::vector<float>({6, 6, 6}));
  EXPECT_TRUE(column_of(cloud, "classification")->is_label);
  EXPECT_EQ(column_of(cloud, "kind")->values, std::vector<float>({1, 2, 3}));
  const PointCloud one = read_e57_file(
      {{{integers("cartesianX", {1}, 1, 1), integers("cartesianY", {2}, 2, 2), integers("cartesianZ", {3}, 3, 3)}}});
  EXPECT_EQ(one.positions, std::vector<Vec3d>({{1, 2, 3}}));
}

TEST(E57, PosesMovePositionsNormalsAndSensors) {
  const std::vector<E57TestField> normals{floats("nor:normalX", {1, 0}), floats("nor:normalY", {0, 0}),
                                          floats("nor:normalZ", {0, 1})};
  // Twice the length of a unit quaternion: 90 degrees about z, x to y.
  const PointCloud cloud =
      read_e57_file({line_scan(2, normals, pose_xml("1.4142135623730951 0 0 1.4142135623730951", "10 20 30"))});
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_LT(norm(cloud.positions[1] - Vec3d{8, 22, 33}), 1e-12);
  EXPECT_LT(norm(cloud.normals[0] - Vec3f{0, 1, 0}), 1e-6f);
  EXPECT_LT(norm(cloud.normals[1] - Vec3f{0, 0, 1}), 1e-6f);
  ASSERT_EQ(cloud.scans.size(), 1u);
  EXPECT_EQ(cloud.scans[0].sensor, (Vec3d{10, 20, 30}));

  const PointCloud translated = read_e57_file({line_scan(1, {}, pose_xml("", "10 20 30"))});
  EXPECT_EQ(translated.positions[0], (Vec3d{11, 22, 33}));
  const PointCloud rotated = read_e57_file({line_scan(1, {}, pose_xml("0 1 0 0", ""))});
  EXPECT_LT(norm(rotated.positions[0] - Vec3d{1, -2, -3}), 1e-15);
  EXPECT_EQ(rotated.scans[0].sensor, (Vec3d{0, 0, 0}));
}

TEST(E57, SphericalCoordinatesAreConverted) {
  const double pi = std::acos(-1.0);
  ReadReport report;
  const PointCloud cloud = read_e57_file(
      {{{doubles("sphericalRange", {2, 2, 2, 0, 5}), doubles("sphericalAzimuth", {0, pi / 2, 0, 1, 1}),
         doubles("sphericalElevation", {0, 0, pi / 2, 1, 1}), integers("sphericalInvalidState", {0, 0, 0, 0, 1}, 0, 1)},
        pose_xml("", "1 1 1")}},
      &report);
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_LT(norm(cloud.positions[0] - Vec3d{3, 1, 1}), 1e-15);
  EXPECT_LT(norm(cloud.positions[1] - Vec3d{1, 3, 1}), 1e-15);
  EXPECT_LT(norm(cloud.positions[2] - Vec3d{1, 1, 3}), 1e-15);
  EXPECT_EQ(report.files[0].no_return, 2u);
  EXPECT_EQ(cloud.scans[0].sensor, (Vec3d{1, 1, 1}));
}

TEST(E57, CartesianCoordinatesComeBeforeSphericalOnes) {
  const std::vector<E57TestField> spherical{doubles("sphericalRange", {9, 9}), doubles("sphericalAzimuth", {0, 0}),
                                            doubles("sphericalElevation", {0, 0}),
                                            integers("sphericalInvalidState", {1, 1}, 0, 1)};
  ReadReport report;
  const PointCloud cloud = read_e57_file({line_scan(2, spherical)}, &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{1, 2, 3}, {2, 2, 3}}));
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_TRUE(cloud.columns.empty());
}

TEST(E57, RecordsWithoutAReturnAreDroppedFromAllColumns) {
  ReadReport report;
  const PointCloud cloud = read_e57_file(
      {line_scan(4, {integers("cartesianInvalidState", {0, 2, 1, 0}, 0, 2), floats("intensity", {10, 20, 30, 40}),
                     integers("colorRed", {1, 2, 3, 4}, 0, 255), integers("colorGreen", {1, 2, 3, 4}, 0, 255),
                     integers("colorBlue", {1, 2, 3, 4}, 0, 255)})},
      &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{1, 2, 3}, {4, 2, 3}}));
  EXPECT_EQ(column_of(cloud, "intensity")->values, std::vector<float>({10, 40}));
  EXPECT_EQ(cloud.colors, std::vector<Rgb8>({{1, 1, 1}, {4, 4, 4}}));
  EXPECT_EQ(report.files[0].no_return, 2u);
  EXPECT_EQ(report.files[0].samples, 2u);
}

TEST(E57, OneSampleMayLieAtTheOriginAndSeveralAreNone) {
  const auto scan = [](std::vector<double> x) {
    const std::vector<double> zeros(x.size(), 0);
    std::vector<double> intensity(x.size());
    for (size_t i = 0; i < x.size(); ++i) intensity[i] = static_cast<double>(i);
    return E57TestScan{{floats("cartesianX", x), floats("cartesianY", zeros), floats("cartesianZ", zeros),
                        floats("intensity", intensity)},
                       pose_xml("", "4 5 6")};
  };
  EXPECT_EQ(read_e57_file({scan({0, 1})}).positions, std::vector<Vec3d>({{4, 5, 6}, {5, 5, 6}}));
  ReadReport report;
  const PointCloud cloud = read_e57_file({scan({1, 2}), scan({0, 1, 0, 2})}, &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{5, 5, 6}, {6, 5, 6}, {5, 5, 6}, {6, 5, 6}}));
  EXPECT_EQ(column_of(cloud, "intensity")->values, std::vector<float>({0, 1, 1, 3}));
  EXPECT_EQ(report.files[0].no_return, 2u);
}

TEST(E57, ColorsGoFromLimitToLimit) {
  const auto colors = [](std::vector<E57TestField> fields, const std::string& xml = {}) {
    return read_e57_file({line_scan(3, fields, xml)}).colors;
  };
  const auto channels = [](std::vector<int64_t> values, std::optional<int64_t> low, std::optional<int64_t> high) {
    return std::vector<E57TestField>{integers("colorRed", values, low, high), integers("colorGreen", values, low, high),
                                     integers("colorBlue", values, low, high)};
  };
  const std::vector<Rgb8> steps{{0, 0, 0}, {51, 51, 51}, {255, 255, 255}};
  EXPECT_EQ(colors(channels({0, 51, 255}, 0, 255)), steps);
  EXPECT_EQ(colors(channels({0, 13107, 65535}, 0, 65535)), steps);
  EXPECT_EQ(colors(channels({0, 51, 255}, std::nullopt, std::nullopt)), steps);
  EXPECT_EQ(colors(channels({0, 13107, 65535}, INT64_MIN, INT64_MAX)), steps);
  std::string limits = "<colorLimits type=\"Structure\">";
  for (const char* channel : {"Red", "Green", "Blue"})
    limits += std::string("<color") + channel + "Minimum type=\"Integer\"/><color" + channel +
              "Maximum type=\"Integer\">1000</color" + channel + "Maximum>";
  limits += "</colorLimits>";
  EXPECT_EQ(colors(channels({0, 200, 1000}, 0, 65535), limits), steps);
  const std::vector<E57TestField> unit{floats("colorRed", {0, 0.2, 1}), floats("colorGreen", {0, 0.2, 1}),
                                       floats("colorBlue", {0, 0.2, 1})};
  EXPECT_EQ(colors(unit), steps);
  std::vector<E57TestField> some = channels({0, 51, 255}, 0, 255);
  some.push_back(integers("isColorInvalid", {0, 1, 0}, 0, 1));
  EXPECT_EQ(colors(some)[1], (Rgb8{128, 128, 128}));
}

TEST(E57, RowsAndColumnsAreTheRangeGrid) {
  ReadReport report;
  const PointCloud cloud =
      read_e57_file({line_scan(2), line_scan(6, {integers("cartesianInvalidState", {0, 0, 1, 0, 0, 0}, 0, 1),
                                                 integers("rowIndex", {10, 11, 12, 10, 11, 12}, 0, 20),
                                                 integers("columnIndex", {3, 3, 3, 5, 5, 5}, 0, 20)})},
                    &report);
  EXPECT_TRUE(report.warnings.empty());
  ASSERT_EQ(cloud.scans.size(), 2u);
  EXPECT_FALSE(cloud.scans[0].range_grid);
  ASSERT_TRUE(cloud.scans[1].range_grid);
  EXPECT_EQ(cloud.scans[1].range_grid->rows, 3);
  EXPECT_EQ(cloud.scans[1].range_grid->columns, 3);
  EXPECT_EQ(cloud.scans[1].range_grid->sample, std::vector<int32_t>({0, -1, 2, 1, -1, 3, -1, -1, 4}));
  EXPECT_TRUE(cloud.columns.empty());
}

TEST(E57, FirstReturnTakesTheCell) {
  const std::vector<E57TestField> cells{integers("rowIndex", {0, 0, 1, 1, 0}, 0, 1),
                                        integers("columnIndex", {0, 0, 0, 1, 1}, 0, 1)};
  std::vector<E57TestField> returns = cells;
  returns.push_back(integers("returnIndex", {1, 0, 0, 0, 0}, 0, 3));
  returns.push_back(integers("returnCount", {2, 2, 1, 1, 1}, 0, 3));
  ReadReport report;
  const PointCloud cloud = read_e57_file({line_scan(5, returns)}, &report);
  EXPECT_EQ(cloud.size(), 5u);
  EXPECT_EQ(cloud.scans[0].range_grid->sample, std::vector<int32_t>({1, 4, 2, 3}));
  EXPECT_EQ(column_of(cloud, "returnIndex")->values, std::vector<float>({1, 0, 0, 0, 0}));
  EXPECT_TRUE(report.warnings.empty());

  const PointCloud twice = read_e57_file({line_scan(5, cells)}, &report);
  EXPECT_FALSE(twice.scans[0].range_grid);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("'scan 1': several samples in row 0, column 0"), std::string::npos);
}

TEST(E57, GridsOfFarMoreCellsThanSamplesAreNotUsed) {
  ReadReport report;
  const E57TestScan scan = line_scan(2, {integers("rowIndex", {0, 2000000000}, 0, 2000000000),
                                         integers("columnIndex", {0, 2000000000}, 0, 2000000000)});
  EXPECT_FALSE(read_e57_file({scan, scan}, &report).scans[0].range_grid);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("2000000001 rows"), std::string::npos) << report.warnings[0];
}

TEST(E57, TimesAreFromTheFirstAndInvalidValuesAreNone) {
  const PointCloud cloud = read_e57_file({line_scan(
      4, {doubles("timeStamp", {7, 1.5e9, 1.5e9 + 0.25, 1.5e9 + 1}), integers("isTimeStampInvalid", {1, 0, 0, 0}, 0, 1),
          floats("intensity", {1, 2, 3, 4}), integers("isIntensityInvalid", {0, 0, 1, 0}, 0, 1)})});
  const std::vector<float>& time = column_of(cloud, "time")->values;
  EXPECT_TRUE(std::isnan(time[0]));
  EXPECT_EQ(std::vector<float>(time.begin() + 1, time.end()), std::vector<float>({0, 0.25, 1}));
  EXPECT_TRUE(std::isnan(column_of(cloud, "intensity")->values[2]));
  EXPECT_EQ(cloud.columns.size(), 2u);
}

TEST(E57, ScansAreNamedAndWhatOnlySomeHaveIsNeutralInTheOthers) {
  const auto text = [](const std::string& name, const std::string& value) {
    return "<" + name + " type=\"String\"><![CDATA[" + value + "]]></" + name + ">";
  };
  const std::vector<E57TestField> colors{integers("colorRed", {9}, 0, 255), integers("colorGreen", {8}, 0, 255),
                                         integers("colorBlue", {7}, 0, 255)};
  ReadReport report;
  const PointCloud cloud =
      read_e57_file({line_scan(1, {floats("intensity", {5})}, text("guid", "{1}") + text("name", "north\nwall")),
                     line_scan(0), line_scan(1, colors, text("guid", "{2}")),
                     line_scan(1, {floats("a:odd", {3}), floats("intensity", {4}), floats("b:odd", {6})})},
                    &report);
  ASSERT_EQ(cloud.scans.size(), 3u);
  EXPECT_EQ(cloud.scans[0].name, "north wall");
  EXPECT_EQ(cloud.scans[1].name, "{2}");
  EXPECT_EQ(cloud.scans[2].name, "scan 4");
  EXPECT_EQ(cloud.scans[2].begin, 2u);
  EXPECT_EQ(cloud.colors, std::vector<Rgb8>({{128, 128, 128}, {9, 8, 7}, {128, 128, 128}}));
  ASSERT_EQ(cloud.columns.size(), 3u);
  EXPECT_TRUE(std::isnan(column_of(cloud, "intensity")->values[1]));
  EXPECT_EQ(column_of(cloud, "intensity")->values[2], 4);
  EXPECT_TRUE(std::isnan(column_of(cloud, "odd")->values[0]));
  EXPECT_EQ(column_of(cloud, "odd")->values[2], 3);
  EXPECT_EQ(column_of(cloud, "odd_2")->values[2], 6);
  EXPECT_EQ(report.files[0].format, "E57, 3 scans");
  EXPECT_TRUE(report.warnings.empty());
}

TEST(E57, ElementsMayHaveAnyPrefix) {
  E57TestOptions options;
  options.prefix = "e57:";
  options.root_xml = "<e57:coordinateMetadata type=\"String\">PROJCS[\"UTM\"]</e57:coordinateMetadata>";
  const PointCloud cloud = read_e57_file({line_scan(3)}, nullptr, options);
  EXPECT_EQ(cloud.size(), 3u);
  EXPECT_EQ(cloud.coordinate_system, "PROJCS[\"UTM\"]");
}

TEST(E57, WhatIsNotUsedIsNamedOnce) {
  E57TestOptions options;
  options.root_xml = "<odd type=\"Integer\"/>";
  E57TestScan scan = line_scan(2, {}, "<strange type=\"Float\"/>");
  scan.fields.insert(scan.fields.begin() + 1, {"note", "String", {}, {0, 0}, {}, {}, {}});
  ReadReport report;
  EXPECT_EQ(read_e57_file({scan, scan}, &report, options).positions[3], (Vec3d{2, 2, 3}));
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_NE(report.warnings[0].find("'odd', 'strange'"), std::string::npos) << report.warnings[0];
  EXPECT_NE(report.warnings[1].find("'note' (text)"), std::string::npos) << report.warnings[1];
}

TEST(E57, RecordsBeyondTheCountAreWarnedOf) {
  E57TestScan scan = line_scan(20);
  scan.record_count = 10;
  ReadReport report;
  EXPECT_EQ(read_e57_file({scan}, &report).size(), 10u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("more records than recordCount"), std::string::npos);
}

TEST(E57, IsKnownByItsBeginning) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_points(folder.write("scans.bin", E57Writer::file({line_scan(3)}))).size(), 3u);
}

class RealE57 : public testing::Test {
 protected:
  static PointCloud read(const std::string& name, ReadReport* report = nullptr) {
    return read_points(*real_data("formats/" + name), report);
  }
  void SetUp() override {
    if (!real_data("formats/e57-normals.e57")) GTEST_SKIP() << "no formats in SOAPFILM_DATA";
  }
  static void expect_box(const PointCloud& cloud, Vec3d lo, Vec3d hi, double within) {
    EXPECT_LE(norm(cloud.box().lo - lo), within);
    EXPECT_LE(norm(cloud.box().hi - hi), within);
  }
};

TEST_F(RealE57, FactsHold) {
  ReadReport report;
  const PointCloud two = read("e57-two-scans-moved.e57", &report);
  ASSERT_EQ(two.scans.size(), 2u);
  EXPECT_EQ(two.scans[0].size(), 2u);
  EXPECT_EQ(two.scans[1].size(), 4u);
  EXPECT_EQ(two.scans[0].name, "B2 - Cloud");
  EXPECT_EQ(two.colors.size(), 6u);
  EXPECT_NE(column_of(two, "intensity"), nullptr);
  EXPECT_FALSE(two.scans[0].sensor);
  expect_box(two, {-44.1194, 0.705303, -0.6077}, {-42.6395, 2.0578, 0.6667}, 1e-4);

  const PointCloud normals = read("e57-normals.e57", &report);
  EXPECT_EQ(normals.size(), 2u);
  ASSERT_EQ(normals.normals.size(), 2u);
  for (const Vec3f& n : normals.normals) EXPECT_NEAR(norm(n), 1, 1e-5);

  const PointCloud moved = read("e57-translation-only.e57", &report);
  EXPECT_EQ(moved.size(), 4u);
  expect_box(moved, {4, 5, 6}, {5, 6, 6}, 0);
  EXPECT_EQ(moved.scans[0].sensor, (Vec3d{4, 5, 6}));

  const PointCloud bunny = read("e57-bunny-int32.e57", &report);
  EXPECT_EQ(bunny.size(), 30571u);
  EXPECT_EQ(report.files.back().no_return, 0u);
  expect_box(bunny, {-0.094689, 0.040011, -0.061873}, {0.061009, 0.187321, 0.058799}, 1e-9);

  const PointCloud cube = read("e57-colored-cube-float.e57", &report);
  EXPECT_EQ(cube.size(), 7680u);
  EXPECT_EQ(cube.colors.size(), 7680u);
  expect_box(cube, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 0);
  EXPECT_TRUE(report.warnings.empty());

  expect_refusal<InputError>([] { read("e57-bad-crc.e57"); }, {"e57-bad-crc.e57", "byte 1020", "checksum of page 0"});
}

}  // namespace TEST_FILE
}  // namespace soapfilm
