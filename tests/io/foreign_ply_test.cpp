// PLY as other programs write it: their names, line ends, cameras, faces, and what they leave behind.
#include <fmt/format.h>

#include <bit>

#include "files.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/files.h"

namespace soapfilm {
namespace TEST_FILE {

PointCloud read_text(const std::string& text, ReadReport* report = nullptr) {
  const TemporaryFolder folder;
  return read_points(folder.write("a.ply", text), report);
}

std::string floats(std::initializer_list<double> values) {
  std::string bytes;
  for (const double value : values) {
    auto bits = std::bit_cast<uint32_t>(static_cast<float>(value));
    if constexpr (std::endian::native == std::endian::big) bits = io::swap_bytes(bits);
    bytes.append(reinterpret_cast<const char*>(&bits), sizeof bits);
  }
  return bytes;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string ascii = "ply\nformat ascii 1.0\n";
const std::string binary = "ply\nformat binary_little_endian 1.0\n";

TEST(ForeignPly, LinesMayEndWithLfCrlfOrCrAndBlanks) {
  const std::string head = ascii + "comment sensor 1 2 3\nelement vertex 3\n" + xyz + "end_header\n";
  const std::string text = head + "1 2 3\n4 5 6\n7 8 9\n";
  const std::vector<Vec3d> expected{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  for (const char* end : {"\n", "\r\n", "\r", " \n", "\t \r\n", "  \r"}) {
    const PointCloud cloud = read_text(replaced(text, "\n", end));
    EXPECT_EQ(cloud.positions, expected) << end;
    EXPECT_EQ(cloud.scans.at(0).sensor, (Vec3d{1, 2, 3}));
  }
  EXPECT_EQ(read_text("ply   \n" + text.substr(4)).positions, expected);
  EXPECT_EQ(read_text(replaced(head, "\n", "\r") + "1 2 3\n4 5 6\n7 8 9\n").positions, expected);  // the header alone
}

TEST(ForeignPly, BinaryBodiesMayBeginWithALineEndByte) {
  const std::string head = binary + "element vertex 1\nproperty uchar a\n" + xyz + "end_header\n";
  for (const char* end : {"\n", "\r\n", "\r", " \r"})
    for (const char first : {'\n', '\r', ' '}) {
      const PointCloud cloud = read_text(replaced(head, "\n", end) + first + floats({1, 2, 3}));
      EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{1, 2, 3}})) << end;
      EXPECT_EQ(cloud.columns.at(0).values.at(0), static_cast<float>(first));
    }
}

TEST(ForeignPly, RefusalsOfBareCarriageReturnsNameTheLine) {
  const TemporaryFolder folder;
  const std::string text = ascii + "element vertex 2\n" + xyz + "end_header\n1 2 3\n4 five 6\n";
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const std::string path = folder.write("a.ply", replaced(text, "\n", end));
    expect_refusal<InputError>([&] { read_points(path); }, {"a.ply:9:", "'five'"});
  }
  expect_refusal<InputError>([&] { read_points(folder.write("b.ply", "plywood\n")); }, {"b.ply:1:", "not a PLY"});
}

TEST(ForeignPly, BytesAfterTheLastElementAreNamed) {
  const std::string rows = floats({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15});
  ReadReport report;
  const std::string three = binary + "element vertex 3\n" + xyz + "end_header\n" + rows;
  EXPECT_EQ(read_text(three, &report).size(), 3u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("24 bytes"), std::string::npos);
  EXPECT_NE(report.warnings[0].find("3 vertices"), std::string::npos);
  report = {};
  const std::string big = replaced(three, "little", "big");
  read_text(big + "x", &report);
  ASSERT_GE(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("25 bytes"), std::string::npos);
  report = {};
  read_text(binary + "element vertex 5\n" + xyz + "end_header\n" + rows, &report);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
}

TEST(ForeignPly, NormalsAndScannersHaveManyNames) {
  const auto named = [](std::initializer_list<const char*> names, const std::string& row) {
    std::string text = ascii + "element vertex 1\n" + xyz;
    for (const char* name : names) text += fmt::format("property float {}\n", name);
    return read_text(text + "end_header\n1 2 3 " + row + "\n");
  };
  for (const auto& names : {std::array{"nx", "ny", "nz"},
                            {"normal_x", "normal_y", "normal_z"},
                            {"normalx", "normaly", "normalz"},
                            {"Normal_X", "Normal_Y", "Normal_Z"}})
    EXPECT_EQ(named({names[0], names[1], names[2]}, "0 0 1").normals, std::vector<Vec3f>({{0, 0, 1}})) << names[0];
  for (const auto& names : {std::array{"sensor_x", "sensor_y", "sensor_z"},
                            {"x_origin", "y_origin", "z_origin"},
                            {"sx", "sy", "sz"},
                            {"vp_x", "vp_y", "vp_z"}})
    EXPECT_EQ(named({names[0], names[1], names[2]}, "7 8 9").sensors, std::vector<Vec3d>({{7, 8, 9}})) << names[0];
  const PointCloud other = named({"quality", "confidence", "normal_x"}, "0.5 0.25 1");
  EXPECT_TRUE(other.normals.empty());  // not all three
  ASSERT_EQ(other.columns.size(), 3u);
  EXPECT_EQ(other.columns[0].name, "quality");
  EXPECT_EQ(other.columns[1].values.at(0), 0.25f);
}

TEST(ForeignPly, TheCameraOfARangeMeshIsTheScanner) {
  const std::string camera =
      "element camera 1\nproperty float view_px\nproperty float view_py\nproperty float view_pz\n"
      "property float focal\n";
  const std::string vertex = "element vertex 1\n" + xyz;
  ReadReport report;
  EXPECT_EQ(read_text(ascii + vertex + camera + "end_header\n1 2 3\n10 20 30 1\n", &report).scans.at(0).sensor,
            (Vec3d{10, 20, 30}));
  EXPECT_EQ(read_text(ascii + camera + vertex + "end_header\n10 20 30 1\n1 2 3\n", &report).scans.at(0).sensor,
            (Vec3d{10, 20, 30}));
  EXPECT_EQ(read_text(binary + vertex + camera + "end_header\n" + floats({1, 2, 3, 10, 20, 30, 1})).scans.at(0).sensor,
            (Vec3d{10, 20, 30}));
  EXPECT_FALSE(read_text(ascii + vertex + camera + "end_header\n1 2 3\n0 0 0 1\n", &report).scans.at(0).sensor);
  EXPECT_FALSE(read_text(ascii + vertex + camera + "end_header\n1 2 3\nnan 0 0 1\n", &report).scans.at(0).sensor);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
  const std::string said = replaced(ascii, "1.0\n", "1.0\ncomment sensor 1 1 1\n");
  EXPECT_EQ(read_text(said + vertex + camera + "end_header\n1 2 3\n10 20 30 1\n").scans.at(0).sensor, (Vec3d{1, 1, 1}));
  // Of several cameras none is known to be the scanner.
  EXPECT_FALSE(read_text(ascii + vertex + replaced(camera, "camera 1", "camera 2") +
                             "end_header\n1 2 3\n10 20 30 1\n11 21 31 1\n",
                         &report)
                   .scans.at(0)
                   .sensor);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("'camera'"), std::string::npos);
}

TEST(ForeignPly, FacesTellDirectionsWhereVerticesHaveNoNormals) {
  const std::string vertex = "element vertex 5\n" + xyz;
  const std::string face = "element face 4\nproperty list uchar int vertex_indices\n";
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n";
  const std::string faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  for (const bool faces_first : {false, true}) {
    ReadReport report;
    const PointCloud cloud = read_text(ascii + (faces_first ? face + vertex : vertex + face) + "end_header\n" +
                                           (faces_first ? faces + vertices : vertices + faces),
                                       &report);
    ASSERT_EQ(cloud.normals.size(), 5u);
    const Vec3d center{0.25, 0.25, 0.25};
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_GT(dot(static_cast<Vec3d>(cloud.normals[i]), cloud.positions[i] - center), 0) << i;
      EXPECT_NEAR(norm(cloud.normals[i]), 1, 1e-6);
    }
    EXPECT_LT(norm(static_cast<Vec3d>(cloud.normals[0]) - normalized(Vec3d{-1, -1, -1})), 1e-6);
    EXPECT_EQ(cloud.normals[4], Vec3f{});  // in no face
    EXPECT_EQ(report.files.at(0).format, "PLY, ASCII, normals from its faces");
    ASSERT_EQ(report.warnings.size(), 1u);  // these faces are a tetrahedron's
    EXPECT_NE(report.warnings[0].find("a closed mesh"), std::string::npos) << report.warnings[0];
  }
  // The file's own normals come first, even where its faces say otherwise.
  ReadReport report;
  const std::string own = replaced(vertex, "5\n", "3\n") + "property float nx\nproperty float ny\nproperty float nz\n" +
                          "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const PointCloud cloud = read_text(ascii + own + "0 0 0 0 0 -1\n1 0 0 0 0 -1\n0 1 0 0 0 -1\n3 0 1 2\n", &report);
  EXPECT_EQ(cloud.normals, std::vector<Vec3f>(3, {0, 0, -1}));
  EXPECT_EQ(report.files.at(0).format, "PLY, ASCII");
  EXPECT_EQ(report.warnings, std::vector<std::string>());
}

/// Of a range mesh each edge at its border is passed once; of faces that do not agree where outside is, twice one way.
TEST(ForeignPly, AMeshThatIsNotClosedIsAScan) {
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  for (const std::string faces : {"3 0 2 1\n3 0 1 3\n3 0 3 2\n", "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 3 2\n"}) {
    ReadReport report;
    read_text(ascii + "element vertex 4\n" + xyz + fmt::format("element face {}\n", faces.size() / 8) +
                  "property list uchar int vertex_indices\nend_header\n" + vertices + faces,
              &report);
    EXPECT_EQ(report.warnings, std::vector<std::string>());
  }
}

TEST(ForeignPly, NormalsOfFacesAreWeightedByAreaAtAnyScaleAndPlace) {
  for (const double size : {1e-12, 1.0, 1e9})
    for (const double shift : {0.0, 100.0}) {
      std::string rows;
      for (const auto& [x, y, z] : {std::array{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 1}, {0, 3, 1}})
        rows += fmt::format("{} {} {}\n", (shift + x) * size, (shift + y) * size, (shift + z) * size);
      // A square of area 9 that looks up, one of area 3 that looks along x, and a face of two corners.
      const PointCloud cloud = read_text(ascii + "element vertex 6\n" + replaced(xyz, "float", "double") +
                                         "element face 3\nproperty list uchar int vertex_index\nend_header\n" + rows +
                                         "4 0 1 2 3\n4 4 0 3 5\n2 1 2\n");
      ASSERT_EQ(cloud.normals.size(), 6u);
      EXPECT_LT(norm(static_cast<Vec3d>(cloud.normals[0]) - normalized(Vec3d{3, 0, 9})), 1e-5);
      EXPECT_LT(norm(static_cast<Vec3d>(cloud.normals[1]) - Vec3d{0, 0, 1}), 1e-5);
      EXPECT_LT(norm(static_cast<Vec3d>(cloud.normals[4]) - Vec3d{1, 0, 0}), 1e-5);
    }
}

TEST(ForeignPly, StripsAndFacesWithBrokenVerticesTellNormals) {
  const std::string head =
      ascii + "element vertex 5\n" + xyz + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  const PointCloud cloud = read_text(head + "0 0 0\n1 0 0\n0 1 0\n1 1 0\nnan 0 0\n6 0 1 2 3 -1 0\n");
  EXPECT_EQ(cloud.normals, std::vector<Vec3f>(4, {0, 0, 1}));
  const PointCloud broken = read_text(head + "0 0 0\n1 0 0\n0 1 0\n1 1 0\nnan 0 0\n7 0 1 2 3 4 -1 0\n");
  EXPECT_EQ(broken.normals, std::vector<Vec3f>(4, {0, 0, 1}));
  const TemporaryFolder folder;
  const std::string path = folder.write("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 2\n3 0 1 5\n");
  expect_refusal<InputError>([&] { read_points(path); }, {"a.ply:15:", "index = 5", "0 to 4"});
}

TEST(ForeignPly, ElementsAndListsWithoutMeaningAreNamedOnce) {
  ReadReport report;
  const PointCloud cloud =
      read_text(ascii + "element material 1\nproperty int m\nelement vertex 1\n" + xyz +
                    "property list uchar int links\nelement edge 2\nproperty int a\nproperty int b\nelement nothing 0\n"
                    "property int c\nend_header\n5\n1 2 3 2 0 0\n0 1\n1 0\n",
                &report);
  EXPECT_EQ(cloud.size(), 1u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("element 'material', list 'links' of the vertices, element 'edge'"),
            std::string::npos)
      << report.warnings[0];
  EXPECT_EQ(report.warnings[0].find("nothing"), std::string::npos);
}

TEST(ForeignPly, CoordinatesOf32BitsFarFromTheOriginAreNamed) {
  const auto warnings = [](double offset, const char* type) {
    std::string text = ascii + "element vertex 400\n" + replaced(xyz, "float", type) + "end_header\n";
    for (int i = 0; i < 400; ++i)
      text += fmt::format("{} {} 0\n", 500000 + 0.1 * (i % 20), static_cast<float>(offset + 0.1 * (i / 20)));
    ReadReport report;
    read_text(text, &report);
    return report.warnings;
  };
  ASSERT_EQ(warnings(4649000, "float").size(), 1u);
  EXPECT_NE(warnings(4649000, "float")[0].find("steps of 0.5"), std::string::npos) << warnings(4649000, "float")[0];
  EXPECT_EQ(warnings(4649000, "double"), std::vector<std::string>());
  std::string near = ascii + "element vertex 400\n" + xyz + "end_header\n";
  for (int i = 0; i < 400; ++i) near += fmt::format("{} {} 0\n", 0.1 * (i % 20), 0.1 * (i / 20));
  ReadReport report;
  read_text(near, &report);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
}

TEST(ForeignPly, LinesWithoutAKeywordArePassedOver) {
  const TemporaryFolder folder;
  const std::string rest =
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
  ReadReport report;
  const PointCloud cloud =
      read_points(folder.write("a.ply", "ply\nformat ascii 1.0\nhappy Buddha, standing\n" + rest), &report);
  EXPECT_EQ(cloud.positions.at(0), (Vec3d{1, 2, 3}));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("a.ply:3: 'happy Buddha, standing'"), std::string::npos);
  for (const std::string typo : {"proprety float nx", "elment face 12", "property2 list uchar int a"})
    expect_refusal<InputError>(
        [&] { read_points(folder.write("a.ply", "ply\nformat ascii 1.0\n" + typo + "\n" + rest)); }, {"a.ply:3:"});
}

TEST(ForeignPly, BoolIsAByte) {
  const TemporaryFolder folder;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty bool inlier\nproperty float x\nproperty float "
      "y\nproperty float z\nend_header\n";
  bytes += std::string("\1\0\0\x80\x3F\0\0\0\x40\0\0\x40\x40", 13);
  const PointCloud cloud = read_points(folder.write("a.ply", bytes));
  EXPECT_EQ(cloud.positions.at(0), (Vec3d{1, 2, 3}));
  EXPECT_EQ(cloud.columns.at(0).values, std::vector<float>{1});
}

TEST(ForeignPly, BoolMayBeAWordInText) {
  const TemporaryFolder folder;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty bool inlier\nend_header\n";
  const PointCloud cloud = read_points(folder.write("a.ply", head + "1 2 3 True\n4 5 6 false\n7 8 9 1\n"));
  EXPECT_EQ(cloud.columns.at(0).values, (std::vector<float>{1, 0, 1}));
  expect_refusal<InputError>([&] { read_points(folder.write("a.ply", head + "1 2 3 1\n4 5 6 yes\n7 8 9 1\n")); },
                             {"a.ply:10:", "'yes'"});
}

TEST(ForeignPly, SplatsHaveTheColorOfTheirConstantHarmonic) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_points(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nend_header\n1 2 3 0 -9 9\n1 2 4 1 -1 0.5\n"));
  EXPECT_EQ(cloud.colors, (std::vector<Rgb8>{{128, 0, 255}, {199, 56, 163}}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
