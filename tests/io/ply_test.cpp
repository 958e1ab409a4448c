// PLY: every type, order, format and kind of property; round trips.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdlib>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/files.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

enum class Layout { ascii, little, big };
const char* header_name(Layout layout) {
  return layout == Layout::ascii ? "ascii" : layout == Layout::little ? "binary_little_endian" : "binary_big_endian";
}

/// Writes values as a PLY body in any layout: the tests' own encoder, for types the writer never uses.
class Body {
 public:
  explicit Body(Layout layout) : layout_(layout) {}
  template <class T>
  Body& put(T value) {
    if (layout_ == Layout::ascii) {
      if (!text_.empty() && text_.back() != '\n') text_ += ' ';
      text_ += number(value);
      return *this;
    }
    const bool big = std::endian::native == std::endian::big;
    if ((layout_ == Layout::big) != big) value = io::swap_bytes(value);
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Body& put_as(const std::string& type, double value) {
    if (type == "char" || type == "int8") return put(static_cast<int8_t>(value));
    if (type == "uchar" || type == "uint8") return put(static_cast<uint8_t>(value));
    if (type == "short" || type == "int16") return put(static_cast<int16_t>(value));
    if (type == "ushort" || type == "uint16") return put(static_cast<uint16_t>(value));
    if (type == "int" || type == "int32") return put(static_cast<int32_t>(value));
    if (type == "uint" || type == "uint32") return put(static_cast<uint32_t>(value));
    if (type == "float" || type == "float32") return put(static_cast<float>(value));
    return put(value);
  }
  void end_row() {
    if (layout_ == Layout::ascii) text_ += '\n';
  }
  const std::string& text() const { return text_; }

 private:
  template <class T>
  static std::string number(T value) {
    std::ostringstream out;
    out.precision(17);
    if constexpr (sizeof(T) == 1)
      out << static_cast<int>(value);
    else
      out << value;
    return out.str();
  }
  Layout layout_;
  std::string text_;
};

class PlyTypes : public testing::TestWithParam<std::tuple<Layout, std::string>> {};

TEST_P(PlyTypes, CoordinatesAndListsOfThisTypeAreReadExactly) {
  const auto [layout, type] = GetParam();
  const TemporaryFolder folder;
  std::string text = std::string("ply\nformat ") + header_name(layout) + " 1.0\nelement vertex 3\n";
  const bool is_integer = type != "double" && type.find("float") == std::string::npos;
  const std::string count_type = is_integer ? type : "int";
  text += "property " + type + " z\nproperty list uchar " + type + " extra\nproperty " + type + " x\nproperty " + type +
          " y\nelement face 1\nproperty list " + count_type + " uint16 vertex_index\nend_header\n";
  Body body(layout);
  for (int i = 0; i < 3; ++i) {
    body.put_as(type, 100 - i).put(static_cast<uint8_t>(i));
    for (int k = 0; k < i; ++k) body.put_as(type, k);
    body.put_as(type, i).put_as(type, i * i);
    body.end_row();
  }
  body.put_as(count_type, 3).put(uint16_t{2}).put(uint16_t{0}).put(uint16_t{1});
  body.end_row();
  const std::string path = folder.write("types.ply", text + body.text());

  const PointCloud cloud = read_points(path);
  const std::vector<Vec3d> expected{{0, 0, 100}, {1, 1, 99}, {2, 4, 98}};
  EXPECT_EQ(cloud.positions, expected);
  const Mesh mesh = read_mesh(path);
  EXPECT_EQ(mesh.vertices, expected);
  EXPECT_EQ(mesh.triangles, std::vector<Triangle>({{2, 0, 1}}));
}

INSTANTIATE_TEST_SUITE_P(
    AllTypes, PlyTypes,
    testing::Combine(testing::Values(Layout::ascii, Layout::little, Layout::big),
                     testing::Values("char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8",
                                     "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")),
    [](const auto& test) { return std::string(header_name(std::get<0>(test.param))) + "_" + std::get<1>(test.param); });

class PlyLayouts : public testing::TestWithParam<Layout> {};

TEST_P(PlyLayouts, ForeignElementsAndPropertiesInAnyOrderAreSkipped) {
  const Layout layout = GetParam();
  const TemporaryFolder folder;
  const std::string header = std::string("ply\r\nformat ") + header_name(layout) +
                             " 1.0\r\ncomment made by hand\r\nelement camera 2\r\nproperty float f\r\n"
                             "property list uint double k\r\nelement nothing 5\r\nelement vertex 2\r\n"
                             "property uchar quality\r\nproperty double x\r\nproperty list char short neighbors\r\n"
                             "property double y\r\nproperty double z\r\nelement tail 1\r\nproperty int end\r\n"
                             "end_header\r\n";
  Body body(layout);
  for (int i = 0; i < 2; ++i) {
    body.put(1.5f).put(uint32_t{2}).put(0.25).put(-1e300);
    body.end_row();
  }
  for (int i = 0; i < 2; ++i) {
    body.put(uint8_t{9}).put(i + 0.1).put(static_cast<int8_t>(i));
    for (int k = 0; k < i; ++k) body.put(int16_t{7});
    body.put(0.2).put(1e-17);
    body.end_row();
  }
  body.put(int32_t{-5});
  ReadReport report;
  const PointCloud cloud = read_points(folder.write("order.ply", header + body.text()), &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{0.1, 0.2, 1e-17}, {1.1, 0.2, 1e-17}}));
  ASSERT_EQ(report.files.size(), 1u);
  EXPECT_EQ(report.files[0].properties, std::vector<std::string>({"quality", "x", "neighbors", "y", "z"}));
  EXPECT_EQ(report.files[0].samples, 2u);
  EXPECT_EQ(cloud.scans[0].name, "order");
}

INSTANTIATE_TEST_SUITE_P(AllLayouts, PlyLayouts, testing::Values(Layout::ascii, Layout::little, Layout::big),
                         [](const auto& test) { return std::string(header_name(test.param)); });

/// Rows of nothing but floats in this machine's order have a path of their own, some thousand rows at a time.
TEST(PlyPoints, RowsOfFloatsAreReadAsAnyOther) {
  constexpr int rows = 10'000;
  const std::string names[] = {"z", "nx", "quality", "y", "sensor_z", "ny", "x", "nz", "sensor_x", "sensor_y"};
  const auto value = [](int row, size_t property) {
    return static_cast<float>(row) + 0.125f * static_cast<float>(property);
  };
  const TemporaryFolder folder;
  const auto read = [&](Layout layout, bool weighted) {
    std::string text =
        std::string("ply\nformat ") + header_name(layout) + " 1.0\nelement vertex " + std::to_string(rows);
    for (const std::string& name : names) text += "\nproperty float " + name;
    if (weighted) text += "\nproperty float weight";
    Body body(layout);
    for (int row = 0; row < rows; ++row) {
      for (size_t k = 0; k < std::size(names); ++k) body.put(value(row, k));
      if (weighted) body.put(2.0f);
      body.end_row();
    }
    return read_points(folder.write("floats.ply", text + "\nend_header\n" + body.text()));
  };
  const PointCloud floats = read(Layout::little, false);
  ASSERT_EQ(floats.size(), static_cast<size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    const auto i = static_cast<size_t>(row);
    ASSERT_EQ(floats.positions[i], Vec3d(Vec3f{value(row, 6), value(row, 3), value(row, 0)})) << row;
    ASSERT_EQ(floats.normals[i], (Vec3f{value(row, 1), value(row, 5), value(row, 7)})) << row;
    ASSERT_EQ(floats.sensors[i], Vec3d(Vec3f{value(row, 8), value(row, 9), value(row, 4)})) << row;
  }
  const PointCloud swapped = read(Layout::big, false), weighted = read(Layout::little, true);
  for (const PointCloud* other : {&swapped, &weighted}) {
    EXPECT_EQ(other->positions, floats.positions);
    EXPECT_EQ(other->normals, floats.normals);
    EXPECT_EQ(other->sensors, floats.sensors);
  }
  EXPECT_EQ(weighted.weights, std::vector<float>(rows, 2.0f));
}

/// The C library rounds correctly, and is the judge of every spelling.
TEST(PlyPoints, NumbersInTextAreRoundedCorrectly) {
  std::vector<std::string> spellings{"0",
                                     "-0",
                                     "-0.0",
                                     "007",
                                     "1.",
                                     ".5",
                                     "-.5",
                                     "1e3",
                                     "1E+3",
                                     "1.5e-3",
                                     "1e22",
                                     "1e23",
                                     "1e-22",
                                     "1e-23",
                                     "1e300",
                                     "4.9e-324",
                                     "0.1",
                                     "0.3",
                                     "9007199254740992",
                                     "9007199254740993",
                                     "9007199254740993e-3",
                                     "1234567890123456789",
                                     "12345678901234567890",
                                     "0.00000000000000000000001",
                                     "0.1234567890123456789",
                                     "3.4028234663852886e38",
                                     "+2.5"};
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double value = random.uniform(-1, 1) * std::pow(10.0, random.uniform(-30, 30));
    spellings.push_back(fmt::format("{}", value));
    spellings.push_back(fmt::format("{:.{}f}", random.uniform(-100, 100), i % 18));
    spellings.push_back(fmt::format("{:.{}e}", value, i % 20));
  }
  while (spellings.size() % 3 != 0) spellings.push_back("1");
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
      spellings.size() / 3);
  for (size_t i = 0; i < spellings.size(); ++i) text += spellings[i] + (i % 3 == 2 ? "\n" : " ");
  const TemporaryFolder folder;
  const PointCloud cloud = read_points(folder.write("n.ply", text));
  ASSERT_EQ(3 * cloud.size(), spellings.size());
  for (size_t i = 0; i < spellings.size(); ++i) {
    const double read = cloud.positions[i / 3][static_cast<int>(i % 3)];
    const double expected = std::strtod(spellings[i].c_str(), nullptr);
    EXPECT_EQ(std::bit_cast<uint64_t>(read), std::bit_cast<uint64_t>(expected)) << spellings[i];
  }
}

TEST(PlyPoints, WrittenCloudComesBackWithAllItHas) {
  const TemporaryFolder folder;
  for (const bool ascii : {false, true})
    for (const int scans : {1, 3}) {
      const PointCloud cloud = rich_cloud(scans, 7, 5, 11);
      WriteOptions options;
      options.ascii = ascii;
      options.comments = {"written by a test"};
      const WriteReport report = write_points(folder / "cloud.ply", cloud, options);
      EXPECT_TRUE(report.double_coordinates);
      expect_same_cloud(read_points(folder / "cloud.ply"), cloud);
    }
}

TEST(PlyPoints, CoordinatesAreFloatWhereThatKeepsThePrecision) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.positions = {{1.0 / 3, 0, 0}, {0, 2, 0}};
  WriteOptions options;
  EXPECT_TRUE(write_points(folder / "p.ply", cloud, options).double_coordinates);
  options.coordinate_precision = 1e-7;
  EXPECT_FALSE(write_points(folder / "p.ply", cloud, options).double_coordinates);
  EXPECT_NEAR(read_points(folder / "p.ply").positions[0].x, 1.0 / 3, 1e-7);
  cloud.positions = {{0.5, 0, 0}, {0, 2, 0}};  // exact in float
  EXPECT_FALSE(write_points(folder / "p.ply", cloud).double_coordinates);
}

TEST(PlyPoints, WrittenAsTextAreReadAsTheSameDoubles) {
  const TemporaryFolder folder;
  PointCloud cloud;
  for (const float v : {0.1f, 1e-7f, 123456.789f, 3.4e38f}) cloud.positions.push_back({v, -v, 1.0 / v});
  cloud.sensors.assign(cloud.size(), {0.1f, 0.2f, 0.3f});
  WriteOptions options;
  for (const bool ascii : {false, true}) {
    options.ascii = ascii;
    write_points(folder / "p.ply", cloud, options);
    const PointCloud read = read_points(folder / "p.ply");
    EXPECT_EQ(read.positions, cloud.positions) << ascii;
    EXPECT_EQ(read.sensors, cloud.sensors) << ascii;
  }
}

TEST(PlyPoints, HeaderLinesPlaceTheScanner) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& lines) {
    return read_points(folder.write("s.ply", "ply\nformat ascii 1.0\n" + lines +
                                                 "element vertex 1\nproperty float x\nproperty float y\n"
                                                 "property float z\nend_header\n1 2 3\n"))
        .scans.at(0);
  };
  EXPECT_EQ(read("comment sensor 1 -2.5 3e2\n").sensor, (Vec3d{1, -2.5, 300}));
  EXPECT_EQ(read("obj_info sensor 1 2 3\n").sensor, (Vec3d{1, 2, 3}));
  EXPECT_EQ(read("comment view_direction 0 0 -2\n").view_direction, (Vec3d{0, 0, -1}));
  EXPECT_EQ(read("obj_info scan_name  left side \n").name, "left side");
  const Scan comment = read("comment sensor serial number 1234\ncomment view_direction 0 0 0\n");
  EXPECT_FALSE(comment.sensor || comment.view_direction);
}

TEST(PlyPoints, ColorsOfEveryTypeComeAsBytes) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& type, const std::string& values) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    for (const char* name : {"red", "green", "blue"}) text += "property " + type + " " + name + "\n";
    return read_points(folder.write("c.ply", text + "end_header\n0 0 0 " + values + "\n")).colors.at(0);
  };
  EXPECT_EQ(read("uchar", "0 128 255"), (Rgb8{0, 128, 255}));
  EXPECT_EQ(read("float", "0 0.5 1"), (Rgb8{0, 128, 255}));
  EXPECT_EQ(read("ushort", "0 32896 65535"), (Rgb8{0, 128, 255}));
  EXPECT_EQ(read("float", "0 128 255"), (Rgb8{0, 128, 255})) << "floats as bytes";
  EXPECT_EQ(read("float", "0 0.5 1.004"), (Rgb8{0, 128, 255})) << "a little beyond 1";
  EXPECT_EQ(read("ushort", "0 128 255"), (Rgb8{0, 128, 255})) << "bytes as 16 bits";
  EXPECT_EQ(read("float", "-1 -1 -1"), (Rgb8{128, 128, 128})) << "no color";
  EXPECT_EQ(read("float", "-3 nan 1e9"), (Rgb8{128, 128, 128})) << "no color";
}

TEST(PlyPoints, NonFiniteSamplesAreDroppedAndCounted) {
  const TemporaryFolder folder;
  PointCloud cloud = rich_cloud(2, 4, 3, 5);
  const PointCloud whole = cloud;
  cloud.positions[1].y = nan_value;
  cloud.positions[9].z = std::numeric_limits<double>::infinity();
  cloud.normals[3].x = std::numeric_limits<float>::quiet_NaN();
  cloud.sensors[4].x = nan_value;
  for (const bool ascii : {false, true}) {
    WriteOptions options;
    options.ascii = ascii;
    write_points(folder / "nan.ply", cloud, options);
    ReadReport report;
    const PointCloud read = read_points(folder / "nan.ply", &report);
    EXPECT_EQ(report.dropped(), 2u);
    EXPECT_EQ(report.samples(), cloud.size() - 2);
    EXPECT_EQ(report.files[0].ignored_normals, 1u);
    ASSERT_EQ(read.size(), cloud.size() - 2);
    EXPECT_EQ(read.positions[1], whole.positions[2]);
    EXPECT_EQ(read.normals[2], Vec3f{});
    EXPECT_FALSE(is_finite(read.sensors[3]));
    EXPECT_EQ(read.scans[0].range_grid->sample[1], -1);
    EXPECT_EQ(read.scans[0].range_grid->sample[3], 1);
    EXPECT_EQ(read.scans[1].begin, whole.scans[1].begin - 1);
  }
}

TEST(PlyPoints, StanfordRangeGridIsKept) {
  const TemporaryFolder folder;
  const std::string text =
      "ply\nformat ascii 1.0\nobj_info is_cyberware_data 1\nobj_info num_cols 3\nobj_info num_rows 2\n"
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement range_grid 6\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 1 \n1 0 1 \n1 1 1 \n2 1 1 \n1 0 \n1 1 \n0 \n0 \n1 2 \n1 3 \n";
  const PointCloud cloud = read_points(folder.write("range.ply", text));
  ASSERT_TRUE(cloud.scans.at(0).range_grid);
  EXPECT_EQ(cloud.scans[0].range_grid->columns, 3);
  EXPECT_EQ(cloud.scans[0].range_grid->rows, 2);
  EXPECT_EQ(cloud.scans[0].range_grid->sample, std::vector<int32_t>({0, 1, -1, -1, 2, 3}));

  // However a count of zero is spelled, and whatever follows it.
  for (const char* cells : {"1 0 0 0 0 1 1 0", "1 0\r\n0\r\n0\r\n0\r\n1 1\r\n0\r\n", "1 0\n-0\n00 +0\n1 1\n0e0\n\n"}) {
    const PointCloud sparse = read_points(folder.write("sparse.ply", text.substr(0, text.find("1 0 \n")) + cells));
    EXPECT_EQ(sparse.scans.at(0).range_grid->sample, std::vector<int32_t>({0, -1, -1, -1, 1, -1})) << cells;
  }

  ReadReport report;
  std::string unsized = text;
  unsized.erase(unsized.find("obj_info num_cols 3\n"), 20);
  EXPECT_FALSE(read_points(folder.write("unsized.ply", unsized), &report).scans[0].range_grid);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("num_cols"), std::string::npos);
}

TEST(PlyMesh, WrittenMeshComesBackWithAllItHas) {
  const TemporaryFolder folder;
  const Mesh mesh = torus_mesh(20, 1.0);
  for (const bool ascii : {false, true}) {
    WriteOptions options;
    options.ascii = ascii;
    EXPECT_FALSE(write_mesh(folder / "m.ply", mesh, options).double_coordinates);
    const Mesh read = read_mesh(folder / "m.ply");
    EXPECT_LT(largest_move(read, mesh), 1e-6);
    EXPECT_EQ(read.triangles, mesh.triangles);
    EXPECT_EQ(read.normals, mesh.normals);
    EXPECT_EQ(read.colors, mesh.colors);
    ASSERT_EQ(read.attributes.size(), 2u);
    EXPECT_EQ(read.attributes[0].name, "height");
    EXPECT_EQ(read.attributes[0].values, mesh.attributes[0].values);
    EXPECT_EQ(read.attributes[1].values, mesh.attributes[1].values);
  }
}

TEST(PlyMesh, PolygonsAndStripsBecomeTriangles) {
  const TemporaryFolder folder;
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string rows = "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 2 0\n";
  const Mesh fan = read_mesh(folder.write(
      "fan.ply", vertices + "element face 1\nproperty list uchar int vertex_indices\n" + rows + "5 0 1 2 3 4\n"));
  EXPECT_EQ(fan.triangles, std::vector<Triangle>({{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  const Mesh strip =
      read_mesh(folder.write("strip.ply", vertices + "element tristrips 1\nproperty list int int vertex_indices\n" +
                                              rows + "8 0 1 3 2 -1 2 4 3\n"));
  EXPECT_EQ(strip.triangles, std::vector<Triangle>({{0, 1, 3}, {3, 1, 2}, {2, 4, 3}}));
}

TEST(PlyMesh, CountsAndIndicesAreReadInAnySpelling) {
  const TemporaryFolder folder;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const char* face :
       {"3 2 1 0", "003 02 01 00", "+3 2.0 1e0 -0", "3.0 20e-1 1 0", "\t3\n2 \r\n1\n\n0", "3 0000000002 1 0"}) {
    const Mesh mesh = read_mesh(folder.write("a.ply", head + face));
    ASSERT_EQ(mesh.triangles.size(), 2u) << face;
    EXPECT_EQ(mesh.triangles[1], (Triangle{2, 1, 0})) << face;
  }
}

TEST(Ply, KindFollowsFromTheFaces) {
  const TemporaryFolder folder;
  write_points(folder / "cloud.ply", rich_cloud(1, 3, 3, 1));
  write_mesh(folder / "mesh.ply", torus_mesh(5, 1));
  EXPECT_EQ(file_kind(folder / "cloud.ply"), FileKind::points);
  EXPECT_EQ(file_kind(folder / "mesh.ply"), FileKind::mesh);
  EXPECT_EQ(read_points(folder / "mesh.ply").size(), 25u);
  std::filesystem::copy(folder / "mesh.ply", folder / "mesh.data");  // known by its first line
  EXPECT_EQ(read_mesh(folder / "mesh.data").triangles.size(), 50u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
