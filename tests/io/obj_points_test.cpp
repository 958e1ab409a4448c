// OBJ as a cloud, and which of cloud and mesh a file is.
#include <fmt/format.h>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"

namespace soapfilm {
namespace TEST_FILE {

PointCloud read_text(const std::string& text, ReadReport* report = nullptr) {
  const TemporaryFolder folder;
  return read_points(folder.write("a.obj", text), report);
}

TEST(Obj, LinesGoOnAfterABackslash) {
  const std::string text =
      "# C:\\temp\\\nv 0 0 0\r\nv 1 0 \\\r\n 0\r\nv 0 1 0\r\nv 0 0 1\nf 1/1/ 2// \\  \n\\\n3//\nf 1 2\\\n 4";
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += {c, '\0'};
  const TemporaryFolder folder;
  for (const std::string& bytes : {text, wide}) {
    const std::string path = folder.write("a.obj", bytes);
    EXPECT_EQ(file_kind(path), FileKind::mesh);
    const Mesh mesh = read_mesh(path);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}));
    EXPECT_EQ(read_points(path).positions, mesh.vertices);
  }
  expect_refusal<InputError>([&] { read_mesh(folder.write("a.obj", "v 0 0 \\\n0\nf 1 2 x\n")); }, {"a.obj:3:", "'x'"});
}

TEST(Obj, CornersAtTheOriginAreSamples) {
  ReadReport report;
  const PointCloud cloud = read_text("v 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 4\nf 2 4 5\n", &report);
  EXPECT_EQ(cloud.size(), 5u);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(read_text("v 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", &report).size(), 2u);  // a scan's
}

TEST(ObjPoints, NormalsBelongToVerticesOneToOneWithoutFaces) {
  const std::vector<Vec3d> positions{{1, 2, 3}, {4, 5, 6}};
  const std::vector<Vec3f> normals{{0, 0, 1}, {0, 1, 0}};
  for (const char* text : {"# points\nv 1 2 3\nv 4 5 6\nvn 0 0 1\nvn 0 1 0\n", "v 1 2 3\nvn 0 0 1\nv 4 5 6\nvn 0 1 0",
                           "vn 0 0 1\r\nvn 0 1 0\r\no cloud\r\nv 1 2 3 1.0\r\n  v\t4 5 6\r\np 1 2\r\n"}) {
    ReadReport report;
    const PointCloud cloud = read_text(text, &report);
    EXPECT_EQ(cloud.positions, positions) << text;
    EXPECT_EQ(cloud.normals, normals) << text;
    EXPECT_EQ(report.warnings, std::vector<std::string>());
    EXPECT_EQ(report.files.at(0).format, "OBJ");
    EXPECT_EQ(cloud.scans.at(0).name, "a");
  }
}

TEST(ObjPoints, NormalsThatDoNotCorrespondAreNamed) {
  ReadReport report;
  const PointCloud cloud = read_text("v 1 2 3\nv 4 5 6\nvn 0 0 1\n", &report);
  EXPECT_TRUE(cloud.normals.empty());
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("1 normals (vn) for 2 vertices"), std::string::npos);
}

TEST(ObjPoints, ColorsFollowTheCoordinates) {
  EXPECT_EQ(read_text("v 1 2 3 0 0.5 1\nv 4 5 6 1 0 0\n").colors, std::vector<Rgb8>({{0, 128, 255}, {255, 0, 0}}));
  EXPECT_EQ(read_text("v 1 2 3 0 128 255\nv 4 5 6 1 0 0\n").colors, std::vector<Rgb8>({{0, 128, 255}, {1, 0, 0}}));
  EXPECT_EQ(read_text("v 0 0 1\nv 1 2 3 0 0.5 1\nv 4 5 6\n").colors,
            std::vector<Rgb8>({{128, 128, 128}, {0, 128, 255}, {128, 128, 128}}));
  EXPECT_TRUE(read_text("v 0 0 1\n").colors.empty());
}

TEST(ObjPoints, OfAMeshTheNormalsOfVnLinesOrElseOfTheFacesAreUsed) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\n";
  const std::string normals = "vn 0 0 -1\nvn 0 0 -1\nvn 0 0 -1\nvn 0 0 -1\nvn 0 0 -1\n";
  ReadReport report;
  EXPECT_EQ(read_text(vertices + normals + "f 1//1 2//2 3/7/3 4//4\n", &report).normals,
            std::vector<Vec3f>(5, {0, 0, -1}));
  EXPECT_EQ(report.files.at(0).format, "OBJ");
  const std::vector<Vec3f> up{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 0}};
  for (const std::string& text : {vertices + "f 1 2 3 4\n", "f 1 2 3 4\n" + vertices, vertices + "f -5 -4 -3 -2\n",
                                  vertices + normals + "f 1//1 2//1 3//1 4//1\n", vertices + normals + "f 1 2 3 4\n",
                                  std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf 1 3 4\nv 5 5 5\n")}) {
    report = {};
    EXPECT_EQ(read_text(text, &report).normals, up) << text;
    EXPECT_EQ(report.files.at(0).format, "OBJ, normals from its faces");
    EXPECT_EQ(report.warnings, std::vector<std::string>());
  }
}

TEST(ObjPoints, WhatIsNotUsedIsNamedOnce) {
  ReadReport report;
  read_text("mtllib a.mtl\nvt 0 0\nv 1 2 3 0.5\nv 4 5 6 0.5\nl 1 2\ncurv 1 2\nl 2 1\ns off\n", &report);
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_NE(report.warnings[0].find("'l', 'curv'"), std::string::npos);
  EXPECT_NE(report.warnings[1].find("only x y z"), std::string::npos);
}

TEST(ObjPoints, BrokenSamplesAreDroppedAndCounted) {
  ReadReport report;
  EXPECT_EQ(read_text("v 1 2 3\nv nan 5 6\nv 4 5 6\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n", &report).normals,
            std::vector<Vec3f>({{0, 0, 1}, {1, 0, 0}}));
  EXPECT_EQ(report.dropped(), 1u);
}

TEST(ObjPoints, AFileWithoutFacesIsACloud) {
  const TemporaryFolder folder;
  EXPECT_EQ(file_kind(folder.write("a.obj", "v 1 2 3\nvn 0 0 1\nfoo\nfar 1\n# f 1 2 3\n")), FileKind::points);
  EXPECT_EQ(file_kind(folder.write("a.obj", "v 1 2 3\nv 0 0 1\nv 0 0 2\n  f 1 2 3")), FileKind::mesh);
  EXPECT_EQ(file_kind(folder.write("a.obj", "v 1 2 3\r\nv 0 0 1\r\nv 0 0 2\r\nf\t1 2 3\r\n")), FileKind::mesh);
  write_mesh(folder / "mesh.obj", torus_mesh(6, 1));
  EXPECT_EQ(file_kind(folder / "mesh.obj"), FileKind::mesh);
  EXPECT_EQ(read_points(folder / "mesh.obj").normals.size(), 36u);
}

TEST(ObjPoints, Refusals) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& text, std::initializer_list<std::string> parts) {
    const std::string path = folder.write("a.obj", text);
    expect_refusal<InputError>([&] { read_points(path); }, parts);
    expect_refusal<InputError>([&] { read_points(path); }, {path});
  };
  expect("v 1 2 3\nv 4 5\n", {"a.obj:2:", "2 numbers"});
  expect("v 1 2 3\nv 4 five 6\n", {"a.obj:2:", "'five'"});
  expect("v 1 2 3\nv 1 2 3 4 5 6 7 8 9\n", {"a.obj:2:", "more than 8"});
  expect("v 1 2 3\nvn 1 2\n", {"a.obj:2:", "3 numbers"});
  expect("v 1 2 3\nf 1 1 2\n", {"a.obj:2:", "vertex 2", "1 to 1"});
  expect("v 1 2 3\nf 1 1 -2\n", {"a.obj:2:", "index -2"});
  expect("v 1 2 3\nf 1 1 9223372036854775807\n", {"a.obj:2:", "9223372036854775807"});
  expect("v 1 2 3\nf 1 1 x\n", {"a.obj:2:", "'x'"});
  expect("o nothing\n", {"holds no samples"});
  expect("v inf 2 3\n", {"none of its 1 samples"});
}

}  // namespace TEST_FILE
}  // namespace soapfilm
