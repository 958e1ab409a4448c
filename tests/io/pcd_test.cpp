// PCD: fields of every type in every coding, colors, range images, viewpoints; real files when SOAPFILM_DATA names the
// data.
#include <fmt/format.h>

#include <bit>
#include <map>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/byte_source.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/lzf.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

enum class Coding { ascii, binary, compressed, stored };

/// LZF of any bytes: the tests' own compressor, greedy, with all kinds of copies.
std::string lzf(const std::string& bytes) {
  std::string out, literals;
  std::map<std::string, size_t> seen;
  const auto flush = [&] {
    for (size_t i = 0; i < literals.size(); i += 32) {
      const std::string part = literals.substr(i, 32);
      out += static_cast<char>(part.size() - 1);
      out += part;
    }
    literals.clear();
  };
  for (size_t i = 0; i < bytes.size();) {
    const std::string three = bytes.substr(i, 3);
    const auto found = seen.find(three);
    size_t length = 0;
    if (three.size() == 3 && found != seen.end() && i - found->second <= 8192)
      while (length < 264 && i + length < bytes.size() && bytes[found->second + length] == bytes[i + length]) ++length;
    if (length >= 3) {
      flush();
      const size_t distance = i - found->second - 1, extra = length - 2;
      out += static_cast<char>(std::min<size_t>(extra, 7) << 5 | distance >> 8);
      if (extra >= 7) out += static_cast<char>(extra - 7);
      out += static_cast<char>(distance & 255);
    } else {
      length = 1;
      literals += bytes[i];
    }
    seen[three] = i;
    i += length;
  }
  flush();
  return out;
}

struct Field {
  std::string name;
  std::string type = "F";
  int size = 4;
  int count = 1;
};

template <class T>
std::string bytes_of(T value) {
  if constexpr (std::endian::native == std::endian::big) value = io::swap_bytes(value);
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string encode(const Field& field, double v) {
  if (field.type == "F") return field.size == 4 ? bytes_of(static_cast<float>(v)) : bytes_of(v);
  if (field.type == "I") {
    const auto i = static_cast<int64_t>(v);
    return bytes_of(i).substr(0, static_cast<size_t>(field.size));
  }
  return bytes_of(static_cast<uint64_t>(v)).substr(0, static_cast<size_t>(field.size));
}

std::string sized(uint64_t packed, uint64_t full) {
  return bytes_of(static_cast<uint32_t>(packed)) + bytes_of(static_cast<uint32_t>(full));
}

/// A file of these fields and rows, of which each has all values of all fields.
class Pcd {
 public:
  std::vector<Field> fields{{"x"}, {"y"}, {"z"}};
  std::vector<std::vector<double>> rows;
  size_t width = 0, height = 1;  // 0: as many as there are rows
  std::string viewpoint = "VIEWPOINT 0 0 0 1 0 0 0\n";

  std::string header(Coding coding) const {
    std::string names, sizes, types, counts;
    for (const Field& field : fields) {
      names += " " + field.name;
      sizes += fmt::format(" {}", field.size);
      types += " " + field.type;
      counts += fmt::format(" {}", field.count);
    }
    const char* data = coding == Coding::ascii ? "ascii" : coding == Coding::binary ? "binary" : "binary_compressed";
    return fmt::format(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\n"
        "WIDTH {}\nHEIGHT {}\n{}POINTS {}\nDATA {}\n",
        names, sizes, types, counts, width > 0 ? width : rows.size(), height, viewpoint, rows.size(), data);
  }
  std::string text(Coding coding) const { return header(coding) + body(coding); }

  std::string body(Coding coding) const {
    std::string text, planes;
    if (coding == Coding::ascii) {
      for (const auto& row : rows) text += fmt::format("{}\n", fmt::join(row, " "));
      return text;
    }
    if (coding == Coding::binary) {
      for (const auto& row : rows) {
        size_t at = 0;
        for (const Field& field : fields)
          for (int k = 0; k < field.count; ++k) text += encode(field, row[at++]);
      }
      return text;
    }
    size_t first = 0;
    for (const Field& field : fields) {
      for (const auto& row : rows)
        for (int k = 0; k < field.count; ++k) planes += encode(field, row[first + static_cast<size_t>(k)]);
      first += static_cast<size_t>(field.count);
    }
    const std::string packed = coding == Coding::stored ? planes : lzf(planes);
    return sized(packed.size(), planes.size()) + packed;
  }
};

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

class PcdCodings : public testing::TestWithParam<Coding> {};

TEST_P(PcdCodings, FieldsOfEveryTypeAreReadExactly) {
  for (const Field& type :
       {Field{"", "F", 4}, Field{"", "F", 8}, Field{"", "I", 1}, Field{"", "I", 2}, Field{"", "I", 4},
        Field{"", "I", 8}, Field{"", "U", 1}, Field{"", "U", 2}, Field{"", "U", 4}, Field{"", "U", 8}}) {
    Pcd pcd;
    pcd.fields.clear();
    for (const char* name : {"time", "z", "x", "y"}) pcd.fields.push_back({name, type.type, type.size});
    const double low = type.type == "I" ? -100 : 0;
    for (int i = 0; i < 5; ++i) pcd.rows.push_back({7.0 + i, low + i, 100 - i, 2.0 * i});
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
  Pcd pcd;
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
  Pcd pcd;
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
    Pcd pcd;
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
  Pcd pcd;
  for (const char* name : {"b", "g", "r"}) pcd.fields.push_back({name, "U", 1});
  pcd.rows = {{1, 2, 3, 0, 128, 255}, {1, 2, 4, 1, 2, 3}};
  EXPECT_EQ(read_pcd(pcd.text(GetParam())).colors, std::vector<Rgb8>({{255, 128, 0}, {3, 2, 1}}));
  for (const size_t k : {3, 4, 5}) pcd.fields[k] = {pcd.fields[k].name, "F", 4};
  pcd.rows = {{1, 2, 3, 0, 0.5, 1}, {1, 2, 4, 1, 0, 0}};
  EXPECT_EQ(read_pcd(pcd.text(GetParam())).colors, std::vector<Rgb8>({{255, 128, 0}, {0, 0, 255}}));
}

TEST_P(PcdCodings, OrganisedCloudsAreRangeImages) {
  for (const double missing : {nan_value, 0.0}) {
    Pcd pcd;
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
  Pcd pcd;
  pcd.width = 1;
  pcd.height = 2;
  pcd.rows = {{1, 2, 3}, {0, 0, 0}};  // one sample at the origin is a sample
  const PointCloud cloud = read_pcd(pcd.text(GetParam()));
  EXPECT_EQ(cloud.size(), 2u);
  EXPECT_FALSE(cloud.scans.at(0).range_grid);
}

TEST_P(PcdCodings, ManyPointsComeInOrder) {
  Random random(3);
  Pcd pcd;
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
  Pcd pcd;
  for (int i = 0; i < 6; ++i) pcd.rows.push_back({1.25 * i, 2.5, 3.75});
  const std::string text = pcd.text(GetParam());
  const TemporaryFolder folder;
  for (size_t length = 1; length + 1 < text.size() - (GetParam() == Coding::ascii ? 4 : 0); ++length) {
    const std::string path = folder.write("cut.pcd", text.substr(0, length));
    EXPECT_THROW(read_points(path), InputError) << length;
  }
}

std::string coding_name(const testing::TestParamInfo<Coding>& test) {
  constexpr const char* names[] = {"ascii", "binary", "compressed", "stored"};
  return names[static_cast<size_t>(test.param)];
}

INSTANTIATE_TEST_SUITE_P(AllCodings, PcdCodings,
                         testing::Values(Coding::ascii, Coding::binary, Coding::compressed, Coding::stored),
                         coding_name);

TEST(Pcd, CompressedContentMayLackThePadding) {
  Pcd whole;
  whole.fields = {{"x"}, {"_", "U", 1, 2}, {"y"}, {"z"}};
  whole.rows = {{1, 9, 9, 2, 3}, {4, 9, 9, 5, 6}};
  Pcd bare;
  bare.rows = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(read_pcd(whole.header(Coding::compressed) + bare.body(Coding::compressed)).positions,
            std::vector<Vec3d>({{1, 2, 3}, {4, 5, 6}}));
}

TEST(Pcd, ColorsOfTextMayBeWholeNumbersWhateverTheirType) {
  Pcd pcd;
  pcd.fields.push_back({"rgb", "F"});
  pcd.rows = {{1, 2, 3, 16744449}, {1, 2, 4, 4.2108e6}};
  EXPECT_EQ(read_pcd(pcd.text(Coding::ascii)).colors, std::vector<Rgb8>({{255, 128, 1}, {64, 64, 112}}));
}

TEST(Pcd, TheViewpointIsTheScannersPositionUnlessItIsTheDefault) {
  Pcd pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  const auto read = [&](const std::string& viewpoint, bool trust, ReadReport* report = nullptr) {
    pcd.viewpoint = viewpoint;
    ReadOptions options;
    options.trust_viewpoint = trust;
    const PointCloud cloud = read_pcd(pcd.text(Coding::binary), report, options);
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
  Pcd pcd;
  pcd.rows = {{1, 2, 3}};
  for (const char* name : {"cloud.txt", "cloud.bin", "cloud"})
    EXPECT_EQ(read_pcd(pcd.text(Coding::binary), nullptr, {}, name).size(), 1u) << name;
  EXPECT_EQ(read_pcd("VERSION 0.7\nFIELDS x y z\nPOINTS 1\nDATA ascii\n1 2 3\n", nullptr, {}, "c.xyz").size(), 1u);
}

TEST(Pcd, BytesAfterTheLastPointAreNamed) {
  Pcd pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  for (const Coding coding : {Coding::binary, Coding::compressed}) {
    ReadReport report;
    EXPECT_EQ(read_pcd(pcd.text(coding) + std::string(24, 'x'), &report).size(), 2u);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_NE(report.warnings[0].find("24 bytes after the last of 2 points"), std::string::npos);
  }
}

TEST(Pcd, ZerosAfterCompressedDataArePadding) {
  Pcd pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  ReadReport report;
  EXPECT_EQ(read_pcd(pcd.text(Coding::compressed) + std::string(3000, '\0'), &report).size(), 2u);
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
  Pcd pcd;
  pcd.rows = {{1, 2, 3}, {4, 5, 6}};
  const std::string head = pcd.header(Coding::compressed);
  const std::string packed = lzf(std::string(24, 'a'));
  EXPECT_EQ(read_pcd(head + sized(packed.size(), 24) + packed).size(), 2u);
  expect_refused(head + "123", {"byte", "truncated"});
  expect_refused(head + sized(4000000000u, 24) + packed, {"compressed size = 4000000000", "truncated"});
  expect_refused(head + sized(packed.size(), 25) + packed, {"full size = 25", "2 points of 12 bytes"});
  expect_refused(head + sized(packed.size() - 1, 24) + packed, {"broken"});
  const std::string before = std::string("\x00", 1) + "a" + std::string("\xe0\x0f\x01", 3);  // copies from before
  expect_refused(head + sized(before.size(), 24) + before, {"broken", "24 bytes"});
  const std::string many = "VERSION 0.7\nFIELDS x y z\nWIDTH 357913941\nHEIGHT 1\nDATA binary_compressed\n";
  expect_refused(many + sized(packed.size(), 4294967292u) + packed, {"broken"});
}

TEST(Lzf, DecodesWhatACompressorMakesInPiecesOfAnySize) {
  Random random(7);
  for (int i = 0; i < 40; ++i) {
    std::string bytes;
    const auto letters = 1 + static_cast<int>(random.uniform(0, 250));
    while (bytes.size() < static_cast<size_t>(i * i * 150)) {
      const auto back = static_cast<size_t>(random.uniform(1, 9000));
      if (random.uniform() < 0.1 && back <= bytes.size())
        for (int k = 0; k < 400; ++k) bytes += bytes[bytes.size() - back];
      bytes += static_cast<char>(random.uniform(0, letters));
    }
    const std::string packed = lzf(bytes);
    ASSERT_EQ(io::lzf_decoded_size(packed), bytes.size());
    io::LzfBytes decoder(packed);
    for (size_t at = 0; at < bytes.size();) {
      const size_t count = std::min(bytes.size() - at,
                                    static_cast<size_t>(random.uniform(1, static_cast<double>(decoder.most_at_once))));
      ASSERT_EQ(std::string(decoder.take(count), count), bytes.substr(at, count));
      at += count;
    }
    EXPECT_EQ(decoder.used(), packed.size());
  }
  EXPECT_EQ(io::lzf_decoded_size(std::string("\x20\x00", 2)), std::nullopt);  // a copy of nothing
  EXPECT_EQ(io::lzf_decoded_size("\x05"
                                 "abc"),
            std::nullopt);  // a literal run that ends early
  EXPECT_EQ(io::lzf_decoded_size(std::string("\x00"
                                             "a\xe0\x01",
                                             4)),
            std::nullopt);  // a copy that ends early
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

}  // namespace TEST_FILE
}  // namespace soapfilm
