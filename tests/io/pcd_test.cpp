// PCD: fields of every type in every coding, colors, range images, viewpoints; real files when SOAPFILM_DATA names the
// data.
#include <fmt/format.h>

#include <bit>

#include "files.h"
#include "pcd_files.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

PointCloud read_pcd(const std::string& text, ReadReport* report = nullptr, const ReadOptions& options = {},
                    const std::string& name = "a.pcd") {
  const TemporaryFolder folder;
  return read_points(folder.write(name, text), report, Context(1), options);
}

void expect_refused(const std::string& text, std::initializer_list<std::string> parts) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.pcd", text);
  expect_refusal<InputError>([&] { read_points(path); }, parts);
  expect_refusal<InputError>([&] { read_points(path); }, {path});
}

class PcdCodings : public testing::TestWithParam<PcdCoding> {};

TEST_P(PcdCodings, FieldsOfEveryTypeAreReadExactly) {
  for (const PcdColumn& type :
       {PcdColumn{"", "F", 4}, PcdColumn{"", "F", 8}, PcdColumn{"", "I", 1}, PcdColumn{"", "I", 2},
        PcdColumn{"", "I", 4}, PcdColumn{"", "I", 8}, PcdColumn{"", "U", 1}, PcdColumn{"", "U", 2},
        PcdColumn{"", "U", 4}, PcdColumn{"", "U", 8}}) {
    PcdFile pcd;
    pcd.fields.clear();
    for (const char* name : {"time", "z", "x", "y"}) pcd.fields.push_back({name, type.type, type.size});
    const double low = type.type == "I" ? -100 : 0;
    for (int i = 0; i < 5; ++i) pcd.rows.push_back({7.0 + i, low + i, 100.0 - i, 2.0 * i});
    ReadReport report;
    const PointCloud cloud = read_pcd(pcd.text(GetParam()), &report);
    ASSERT_EQ(cloud.size(), 5u);
    for (size_t i = 0; i < 5; ++i) {
      const auto k = static_cast<double>(i);
      EXPECT_EQ(cloud.positions[i], (Vec3d{100 - k, 2 * k, low + k})) << type.type << type.size;
      EXPECT_EQ(cloud.columns.at(0).values[i], static_cast<float>(7 + k));
    }
    EXPECT_EQ(cloud.columns[0].name, "time");
    EXPECT_EQ(report.warnings, std::vector<std::string>());
    EXPECT_EQ(report.files.at(0).properties, std::vector<std::string>({"time", "z", "x", "y"}));
  }
}

TEST_P(PcdCodings, NamesSayWhatFieldsMeanAndPaddingIsSkipped) {
  PcdFile pcd;
  pcd.fields = {{"x"},
                {"y"},
                {"z"},
                {"_", "U", 1, 4},
                {"normal_x"},
                {"normal_y"},
                {"normal_z"},
                {"_", "U", 1, 3},
                {"intensity", "U", 2},
                {"ring", "U", 1},
                {"vp_x"},
                {"vp_y"},
                {"vp_z"},
                {"weight"}};
  pcd.rows = {{1, 2, 3, 9, 9, 9, 9, 0, 0, 1, 8, 8, 8, 500, 3, 10, 20, 30, 2},
              {4, 5, 6, 9, 9, 9, 9, 0, 1, 0, 8, 8, 8, 65535, 4, 10, 20, 31, 0.5}};
  ReadReport report;
  const PointCloud cloud = read_pcd(pcd.text(GetParam()), &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(cloud.normals, std::vector<Vec3f>({{0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(cloud.sensors, std::vector<Vec3d>({{10, 20, 30}, {10, 20, 31}}));
  EXPECT_EQ(cloud.weights, std::vector<float>({2, 0.5f}));
  ASSERT_EQ(cloud.columns.size(), 2u);
  EXPECT_EQ(cloud.columns[0].values, std::vector<float>({500, 65535}));
  EXPECT_EQ(cloud.columns[1].name, "ring");
  EXPECT_TRUE(cloud.columns[1].is_label);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
}

TEST_P(PcdCodings, FieldsOfManyValuesAreSkippedWithOneWarning) {
  PcdFile pcd;
  pcd.fields = {{"fpfh", "F", 4, 33}, {"x"}, {"y"}, {"hist", "U", 2, 2}, {"z"}};
  for (int i = 0; i < 3; ++i) {
    std::vector<double> row(33, 0.5);
    row.insert(row.end(), {1.0 * i, 2, 7, 7, 3});
    pcd.rows.push_back(row);
  }
  ReadReport report;
  const PointCloud cloud = read_pcd(pcd.text(GetParam()), &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{0, 2, 3}, {1, 2, 3}, {2, 2, 3}}));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("'fpfh', 'hist'"), std::string::npos);
}

TEST_P(PcdCodings, PackedColorsAreBytesOfAWordOrAFloat) {
  const uint32_t words[] = {0x00ff8001, 0xff102030, 0x00000000};
  for (const std::string type : {"U", "I", "F"}) {
    PcdFile pcd;
    pcd.fields.push_back({type == "U" ? "rgba" : "rgb", type});
    for (const uint32_t word : words) {
      double value = word;
      if (type == "I") value = static_cast<int32_t>(word);
      if (type == "F") value = static_cast<double>(std::bit_cast<float>(word));
      pcd.rows.push_back({1, 2, 3, value});
    }
    EXPECT_EQ(read_pcd(pcd.text(GetParam())).colors, std::vector<Rgb8>({{255, 128, 1}, {16, 32, 48}, {0, 0, 0}}))
        << type;
  }
}

TEST_P(PcdCodings, SeparateColorsAreRead) {
  PcdFile pcd;
  for (const char* name : {"b", "g", "r"}) pcd.fields.push_back({name, "U", 1});
  pcd.rows = {{1, 2, 3, 0, 128, 255}, {1, 2, 4, 1, 2, 3}};
  EXPECT_EQ(read_pcd(pcd.text(GetParam())).colors, std::vector<Rgb8>({{255, 128, 0}, {3, 2, 1}}));
  for (const size_t k : {3, 4, 5}) pcd.fields[k] = {pcd.fields[k].name, "F", 4};
  pcd.rows = {{1, 2, 3, 0, 0.5, 1}, {1, 2, 4, 1, 0, 0}};
  EXPECT_EQ(read_pcd(pcd.text(GetParam())).colors, std::vector<Rgb8>({{255, 128, 0}, {0, 0, 255}}));
}

TEST_P(PcdCodings, OrganisedCloudsAreRangeImages) {
  for (const double missing : {nan_value, 0.0}) {
    PcdFile pcd;
    pcd.width = 3;
    pcd.height = 2;
    pcd.rows = {{1, 2, 3}, {2, 2, 3}, {3, 2, 3}, {1, 3, 3}, {2, 3, 3}, {missing, missing, missing}};
    std::swap(pcd.rows[1], pcd.rows[5]);
    ReadReport report;
    const PointCloud cloud = read_pcd(pcd.text(GetParam()), &report);
    EXPECT_EQ(cloud.size(), 5u);
    EXPECT_EQ(report.files.at(0).no_return, 1u);
    EXPECT_EQ(report.files[0].dropped, 0u);
    EXPECT_EQ(report.warnings, std::vector<std::string>());
    ASSERT_TRUE(cloud.scans.at(0).range_grid);
    EXPECT_EQ(cloud.scans[0].range_grid->columns, 3);
    EXPECT_EQ(cloud.scans[0].range_grid->rows, 2);
    EXPECT_EQ(cloud.scans[0].range_grid->sample, std::vector<int32_t>({0, -1, 1, 2, 3, 4}));
  }
}

TEST_P(PcdCodings, AColumnOfPointsIsNoRangeImage) {
  PcdFile pcd;
  pcd.width = 1;
  pcd.height = 2;
  pcd.rows = {{1, 2, 3}, {0, 0, 0}};  // one sample at the origin is a sample
  const PointCloud cloud = read_pcd(pcd.text(GetParam()));
  EXPECT_EQ(cloud.size(), 2u);
  EXPECT_FALSE(cloud.scans.at(0).range_grid);
}

TEST_P(PcdCodings, ManyPointsComeInOrder) {
  Random random(3);
  PcdFile pcd;
  pcd.fields.push_back({"label", "U", 2});
  for (int i = 0; i < 70'000; ++i)
    pcd.rows.push_back(
        {0.125 * (i % 17), static_cast<double>(static_cast<float>(random.uniform())), 1.0 * i, 1.0 * (i % 5)});
  const PointCloud cloud = read_pcd(pcd.text(GetParam()));
  ASSERT_EQ(cloud.size(), pcd.rows.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(cloud.positions[i], (Vec3d{pcd.rows[i][0], pcd.rows[i][1], pcd.rows[i][2]})) << i;
    ASSERT_EQ(cloud.columns[0].values[i], static_cast<float>(pcd.rows[i][3]));
  }
}

TEST_P(PcdCodings, EveryCutIsRefused) {
  PcdFile pcd;
  for (int i = 0; i < 6; ++i) pcd.rows.push_back({1.25 * i, 2.5, 3.75});
  const std::string text = pcd.text(GetParam());
  const TemporaryFolder folder;
  for (size_t length = 1; length + 1 < text.size() - (GetParam() == PcdCoding::ascii ? 4 : 0); ++length) {
    const std::string path = folder.write("cut.pcd", text.substr(0, length));
    EXPECT_THROW(read_points(path), InputError) << length;
  }
}

std::string coding_name(const testing::TestParamInfo<PcdCoding>& test) {
  constexpr const char* names[] = {"ascii", "binary", "compressed", "stored"};
  return names[static_cast<size_t>(test.param)];
}

INSTANTIATE_TEST_SUITE_P(AllCodings, PcdCodings,
                         testing::Values(PcdCoding::ascii, PcdCoding::binary, PcdCoding::compressed, PcdCoding::stored),
                         coding_name);

TEST(Pcd, CompressedContentMayLackThePadding) {
  PcdFile whole;
  whole.fields = {{"x"}, {"_", "U", 1, 2}, {"y"}, {"z"}};
  whole.rows = {{1, 9, 9, 2, 3}, {4, 9, 9, 5, 6}};
  PcdFile bare;
  bare.rows = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(read_pcd(whole.header(PcdCoding::compressed) + bare.body(PcdCoding::compressed)).positions,
            std::vector<Vec3d>({{1, 2, 3}, {4, 5, 6}}));
}

TEST(Pcd, ColorsOfTextMayBeWholeNumbersWhateverTheirType) {
  PcdFile pcd;
  pcd.fields.push_back({"rgb", "F"});
  pcd.rows = {{1, 2, 3, 16744449}, {1, 2, 4, 4.2108e6}};
  EXPECT_EQ(read_pcd(pcd.text(PcdCoding::ascii)).colors, std::vector<Rgb8>({{255, 128, 1}, {64, 64, 112}}));
}

TEST(Pcd, TheViewpointIsTheScannersPositionUnlessItIsTheDefault) {
  PcdFile pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  const auto read = [&](const std::string& viewpoint, bool trust, ReadReport* report = nullptr) {
    pcd.viewpoint = viewpoint;
    ReadOptions options;
    options.trust_viewpoint = trust;
    const PointCloud cloud = read_pcd(pcd.text(PcdCoding::binary), report, options);
    EXPECT_EQ(cloud.positions[1], (Vec3d{4, 5, 6}));  // they stay
    return cloud.scans.at(0).sensor;
  };
  EXPECT_EQ(read("VIEWPOINT 10 20 30 1 0 0 0\n", false), (Vec3d{10, 20, 30}));
  EXPECT_FALSE(read("VIEWPOINT 0 0 0 1 0 0 0\n", false));
  EXPECT_FALSE(read("", false));
  EXPECT_EQ(read("VIEWPOINT 0 0 0 1 0 0 0\n", true), (Vec3d{0, 0, 0}));
  EXPECT_EQ(read("", true), (Vec3d{0, 0, 0}));
  ReadReport report;
  EXPECT_EQ(read("VIEWPOINT 0 0 0 0.5 0.5 0.5 0.5\n", false, &report), (Vec3d{0, 0, 0}));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("turned"), std::string::npos);
}

TEST(Pcd, OldHeadersHaveDefaults) {
  // Version .5: no viewpoint, no count; sizes and types of floats.
  const std::string rows = "1 2 3\n4 5 6\n";
  const std::vector<Vec3d> expected{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(
      read_pcd("VERSION .5\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n" + rows).positions,
      expected);
  EXPECT_EQ(read_pcd("COLUMNS x y z\nPOINTS 2\nDATA ascii\n" + rows).positions, expected);
  EXPECT_EQ(read_pcd("# .PCD\r\nFIELDS x y z\r\nWIDTH 2\r\nDATA ascii\r\n1 2 3\r\n\r\n4 5 6").positions, expected);
  ReadReport report;
  EXPECT_EQ(read_pcd("VERSION .5\nFIELDS x y z\nUNIT m\nPOINTS 2\nDATA ascii\n" + rows, &report).positions, expected);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("'UNIT'"), std::string::npos);
}

TEST(Pcd, IsKnownByItsHeadUnderAnyName) {
  PcdFile pcd;
  pcd.rows = {{1, 2, 3}};
  for (const char* name : {"cloud.txt", "cloud.bin", "cloud"})
    EXPECT_EQ(read_pcd(pcd.text(PcdCoding::binary), nullptr, {}, name).size(), 1u) << name;
  EXPECT_EQ(read_pcd("VERSION 0.7\nFIELDS x y z\nPOINTS 1\nDATA ascii\n1 2 3\n", nullptr, {}, "c.xyz").size(), 1u);
}

TEST(Pcd, BytesAfterTheLastPointAreNamed) {
  PcdFile pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  for (const PcdCoding coding : {PcdCoding::binary, PcdCoding::compressed}) {
    ReadReport report;
    EXPECT_EQ(read_pcd(pcd.text(coding) + std::string(24, 'x'), &report).size(), 2u);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_NE(report.warnings[0].find("24 bytes after the last of 2 points"), std::string::npos);
  }
}

TEST(Pcd, ZerosAfterCompressedDataArePadding) {
  PcdFile pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  ReadReport report;
  EXPECT_EQ(read_pcd(pcd.text(PcdCoding::compressed) + std::string(3000, '\0'), &report).size(), 2u);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
}

TEST(Pcd, Refusals) {
  const std::string fields = "VERSION 0.7\nFIELDS x y z\n", xyz = fields + "SIZE 4 4 4\nTYPE F F F\n";
  const std::string rows = "1 2 3\n4 5 6\n";
  expect_refused(xyz + "WIDTH 2\nHEIGHT 1\nPOINTS 3\nDATA ascii\n" + rows + rows, {"a.pcd:7:", "POINTS = 3", "2 * 1"});
  expect_refused(xyz + "WIDTH 3\nHEIGHT 2\nDATA ascii\n" + rows, {"6 points", "truncated"});
  expect_refused(xyz + "POINTS 9000000000000000000\nDATA binary\n" + rows, {"a.pcd:5:", "truncated"});
  expect_refused(xyz + "WIDTH 2147483647\nHEIGHT 2147483647\nDATA binary\n" + rows, {"truncated", "12 bytes are left"});
  expect_refused(xyz + "WIDTH 0\nDATA ascii\n", {"a.pcd:5:", "WIDTH = '0'", "from 1"});
  expect_refused(xyz + "POINTS 2\nDATA ascii\n" + rows + "7 8 9\n", {"a.pcd:9:", "'7 8 9'", "end of the file"});
  expect_refused(xyz + "POINTS 2\nDATA ascii\n1 2 3\n4 5 6 7\n", {"a.pcd:8:", "more than 3"});
  expect_refused(xyz + "POINTS 2\nDATA ascii\n1 2 3\n4 55555\n", {"a.pcd:8:", "point 1", "2 numbers"});
  expect_refused(xyz + "POINTS 2\nDATA ascii\n1 2 3\n4 five 6\n", {"a.pcd:8:", "'five'"});
  expect_refused(xyz + "POINTS 2\n", {"a.pcd:5:", "truncated", "DATA"});
  expect_refused(xyz + "DATA ascii\n" + rows, {"neither WIDTH nor POINTS"});
  expect_refused(xyz + "POINTS 2\nDATA base64\n" + rows, {"a.pcd:6:", "'base64'", "binary_compressed"});
  expect_refused(fields + "SIZE 4 4\n", {"a.pcd:3:", "SIZE has 2", "3 names"});
  expect_refused(fields + "SIZE 4 4 16\n", {"a.pcd:3:", "'16'"});
  expect_refused(fields + "SIZE 4 4 3\nPOINTS 1\nDATA ascii\n1 2 3\n", {"'z'", "SIZE 3"});
  expect_refused(fields + "TYPE F F D\n", {"a.pcd:3:", "'D'", "I, U or F"});
  expect_refused(fields + "COUNT 1 1 0\n", {"a.pcd:3:", "COUNT = '0'"});
  expect_refused(fields + "VIEWPOINT 0 0 0 1 0 0\n", {"a.pcd:3:", "VIEWPOINT of 6"});
  expect_refused("VERSION 0.8\nFIELDS x y z\n", {"a.pcd:1:", "'0.8'", "0.7"});
  expect_refused("VERSION 0.7\nFIELDS x y w\nPOINTS 1\nDATA ascii\n1 2 3\n", {"lacks x, y or z"});
  expect_refused("VERSION 0.7\nFIELDS x y z weight\nPOINTS 1\nDATA ascii\n1 2 3 -1\n", {"point 0", "weight = -1"});
  expect_refused("FIELDS x y z\nFIELDS x y z\n", {"a.pcd:2:", "second FIELDS"});
  expect_refused("solid\n", {"a.pcd:1:", "'solid'", "VERSION"});
}

TEST(Pcd, RefusalsOfCompressedData) {
  PcdFile pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  const std::string head = pcd.header(PcdCoding::compressed);
  const std::string packed = lzf_of(std::string(24, 'a'));
  EXPECT_EQ(read_pcd(head + lzf_sizes(packed.size(), 24) + packed).size(), 2u);
  expect_refused(head + "123", {"byte", "truncated"});
  expect_refused(head + lzf_sizes(4000000000u, 24) + packed, {"compressed size = 4000000000", "truncated"});
  expect_refused(head + lzf_sizes(packed.size(), 25) + packed, {"full size = 25", "2 points of 12 bytes"});
  expect_refused(head + lzf_sizes(packed.size() - 1, 24) + packed, {"broken"});
  const std::string before = std::string("\x00", 1) + "a" + std::string("\xe0\x0f\x01", 3);  // copies from before
  expect_refused(head + lzf_sizes(before.size(), 24) + before, {"broken", "24 bytes"});
  const std::string many = "VERSION 0.7\nFIELDS x y z\nWIDTH 357913941\nHEIGHT 1\nDATA binary_compressed\n";
  expect_refused(many + lzf_sizes(packed.size(), 4294967292u) + packed, {"broken"});
}

void expect_box(const PointCloud& cloud, Vec3d lo, Vec3d hi, double tolerance) {
  const Box3d box = cloud.box();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.lo[axis], lo[axis], tolerance);
    EXPECT_NEAR(box.hi[axis], hi[axis], tolerance);
  }
}

TEST(Pcd, RealFiles) {
  const auto bunny = real_data("formats/pcd-ascii-bun0.pcd");
  const auto color = real_data("formats/pcd-color.pcd");
  const auto car = real_data("formats/pcd-car6.pcd");
  if (!bunny || !color || !car) GTEST_SKIP() << "no formats in SOAPFILM_DATA";
  ReadReport report;
  const PointCloud a = read_points(*bunny, &report);
  EXPECT_EQ(a.size(), 397u);
  expect_box(a, {-0.094, 0.037, -0.055}, {0.060, 0.184, 0.058}, 6e-4);
  EXPECT_EQ(a.normals.size(), 397u);
  EXPECT_EQ(a.columns.at(0).name, "curvature");
  const Vec3d center = 0.5 * (a.box().lo + a.box().hi);
  int inward = 0;
  for (size_t i = 0; i < a.size(); ++i) inward += dot(a.positions[i] - center, static_cast<Vec3d>(a.normals[i])) < 0;
  EXPECT_GT(inward, 300);

  const PointCloud b = read_points(*color, &report);
  EXPECT_EQ(b.size(), 1000u);
  expect_box(b, {-0.887, -0.651, 0.882}, {0.489, -0.375, 1.532}, 6e-4);
  EXPECT_EQ(b.colors.size(), 1000u);
  EXPECT_EQ(b.normals.size(), 1000u);

  const PointCloud c = read_points(*car, &report);
  EXPECT_EQ(c.size(), 10031u);
  expect_box(c, {-40.169, -68.56, -6.99}, {-33.95, -61.88, -5.43}, 6e-3);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
}

TEST(Pcd, ImagesOfDepthCamerasShowWhereTheCameraStood) {
  const auto image = [](const Vec3d& camera, const std::string& viewpoint = "0 0 0 1 0 0 0") {
    std::string text =
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 40\nHEIGHT 30\nVIEWPOINT " + viewpoint +
        "\nPOINTS 1200\nDATA ascii\n";
    for (int r = 0; r < 30; ++r)
      for (int c = 0; c < 40; ++c) {
        const double t = 3 + 0.5 * std::sin(c / 4.0) * std::cos(r / 5.0);
        const Vec3d p = t * Vec3d{(c - 19.5) / 40, (r - 14.5) / 40, 1} + camera;
        text += c == 5 ? "nan nan nan\n" : fmt::format("{:.4f} {:.4f} {:.4f}\n", p.x, p.y, p.z);
      }
    const TemporaryFolder folder;
    return read_points(folder.write("a.pcd", text)).scans.at(0).sensor;
  };
  EXPECT_EQ(image({}), (Vec3d{0, 0, 0}));
  EXPECT_FALSE(image({1, 2, -1}));
  EXPECT_EQ(image({1, 2, -1}, "1 2 -1 1 0 0 0"), (Vec3d{1, 2, -1}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
