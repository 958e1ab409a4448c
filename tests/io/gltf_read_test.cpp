// GLB files as meshes and as clouds: those that are written here, and parts put together by hand.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "binary_bytes.h"
#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"

namespace soapfilm {
namespace TEST_FILE {

std::string glb(std::string json, std::string binary) {
  while (json.size() % 4 != 0) json += ' ';
  while (binary.size() % 4 != 0) binary += '\0';
  const auto word = [](size_t value) { return bytes_of(static_cast<uint32_t>(value)); };
  return "glTF" + word(2) + word(28 + json.size() + binary.size()) + word(json.size()) + "JSON" + json +
         word(binary.size()) + std::string("BIN\0", 4) + binary;
}

template <class T>
std::string numbers(const std::vector<double>& values) {
  std::string bytes;
  for (const double v : values) bytes += bytes_of(static_cast<T>(v));
  return bytes;
}

/// Four corners: positions (float) and colors (16 bits, in four parts) of each beside each other, then indices.
std::string two_triangles() {
  std::string binary;
  for (const Vec3d& p : std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
    binary += numbers<float>({p.x, p.y, p.z}) + numbers<uint16_t>({65535, 32768, 0, 65535});
  return binary + numbers<uint8_t>({0, 1, 2, 0, 3, 1});
}

const std::string views =
    R"("buffers":[{"byteLength":86}],"bufferViews":[{"buffer":0,"byteLength":80,"byteStride":20},)"
    R"({"buffer":0,"byteOffset":80,"byteLength":6}],"accessors":[)"
    R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4},)"
    R"({"bufferView":0,"byteOffset":12,"componentType":5123,"type":"VEC4","count":4,"normalized":true},)"
    R"({"bufferView":1,"componentType":5121,"type":"SCALAR","count":6}])";

std::string scene(const std::string& nodes, const std::string& primitives) {
  return "{" + views + R"(,"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
         R"(],"meshes":[{"primitives":[)" + primitives + "]}]}";
}

const std::string triangles = R"({"attributes":{"POSITION":0,"COLOR_0":1},"indices":2})";
const std::string points = R"({"attributes":{"POSITION":0,"COLOR_0":1},"mode":0})";

TEST(GlbRead, WhatIsWrittenIsReadBack) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(20, 1.0);
  for (Vec3d& v : mesh.vertices) v = v + Vec3d{500000, 4649000, 120};
  write_mesh(folder / "m.glb", mesh);
  EXPECT_EQ(file_kind(folder / "m.glb"), FileKind::mesh);
  const Mesh read = read_mesh(folder / "m.glb");
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  for (size_t i = 0; i < read.vertices.size(); ++i) EXPECT_LT(norm(read.vertices[i] - mesh.vertices[i]), 1e-6);
  EXPECT_EQ(read.triangles, mesh.triangles);
  EXPECT_EQ(read.colors, mesh.colors);
  ASSERT_EQ(read.normals.size(), mesh.normals.size());
  EXPECT_LT(norm(static_cast<Vec3d>(read.normals[7] - mesh.normals[7])), 1e-6);
  ASSERT_EQ(read.attributes.size(), mesh.attributes.size());
  for (const Column& attribute : mesh.attributes) {
    const auto same = [&](const Column& other) { return other.name == attribute.name; };
    const auto found = std::find_if(read.attributes.begin(), read.attributes.end(), same);
    ASSERT_NE(found, read.attributes.end()) << attribute.name;
    EXPECT_EQ(found->values, attribute.values);
  }
  const PointCloud cloud = read_points(folder / "m.glb");
  EXPECT_EQ(cloud.positions, read.vertices);
  EXPECT_EQ(cloud.normals, read.normals);
}

TEST(GlbRead, NodesMoveAndMirror) {
  const TemporaryFolder folder;
  const auto mesh = [&](const std::string& nodes) {
    return read_mesh(folder.write("a.glb", glb(scene(nodes, triangles), two_triangles())));
  };
  const Mesh plain = mesh(R"({"mesh":0})");
  EXPECT_EQ(plain.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 3, 1}}));
  EXPECT_EQ(plain.colors.at(0), (Rgb8{255, 128, 0}));
  // A quarter turn about z (x to y), twice as large, then the parent's shift.
  const Mesh moved = mesh(R"({"children":[1],"translation":[10,20,30]},)"
                          R"({"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,2,2]})");
  EXPECT_LT(norm(moved.vertices[1] - Vec3d{10, 22, 30}), 1e-12);
  EXPECT_LT(norm(moved.vertices[2] - Vec3d{8, 20, 30}), 1e-12);
  EXPECT_EQ(moved.triangles, plain.triangles);
  const Mesh mirrored = mesh(R"({"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]})");
  EXPECT_EQ(mirrored.vertices[1], (Vec3d{4, 6, 7}));
  EXPECT_EQ(mirrored.triangles, (std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}}));
}

TEST(GlbRead, PointsAreACloudAndPrimitivesShareVertices) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.glb", glb(scene(R"({"mesh":0})", points), two_triangles()));
  EXPECT_EQ(file_kind(path), FileKind::points);
  const PointCloud cloud = read_points(path);
  EXPECT_EQ(cloud.size(), 4u);
  EXPECT_TRUE(cloud.normals.empty());
  EXPECT_EQ(cloud.colors.at(3), (Rgb8{255, 128, 0}));
  expect_refusal<InputError>([&] { read_mesh(path); }, {"a.glb", "holds no faces"});
  const std::string both =
      folder.write("b.glb", glb(scene(R"({"mesh":0})", points + "," + triangles), two_triangles()));
  EXPECT_EQ(read_points(both).size(), 4u);
  EXPECT_EQ(read_mesh(both).triangles.size(), 2u);
}

TEST(GlbRead, RefusalsNameWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string whole = glb(scene(R"({"mesh":0})", triangles), two_triangles());
  const auto refused = [&](const std::string& what, const std::string& by, const std::string& part) {
    std::string json = scene(R"({"mesh":0})", triangles);
    const size_t at = json.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    json.replace(at, what.size(), by);
    expect_refusal<InputError>([&] { read_mesh(folder.write("a.glb", glb(json, two_triangles()))); },
                               {"a.glb: ", part});
  };
  refused(R"("asset")", R"("extensionsRequired":["KHR_draco_mesh_compression"],"asset")",
          "'KHR_draco_mesh_compression'");
  refused(R"("asset")", R"("extensionsUsed":["EXT_meshopt_compression"],"asset")", "'EXT_meshopt_compression'");
  refused(R"("count":6)", R"("count":6,"sparse":{})", "sparse");
  refused(R"({"byteLength":86})", R"({"byteLength":86,"uri":"a.bin"})", "another file");
  refused(R"("count":4)", R"("count":5)", "count = 5");
  refused(R"("count":6)", R"("count":-6)", "-6");
  refused(R"("byteStride":20)", R"("byteStride":0)", "byteStride = 0");
  refused(R"("byteLength":80)", R"("byteLength":8000)", "truncated");
  refused(R"("type":"VEC3","count":4)", R"("type":"VEC3","count":3)", "must be 3");
  refused(R"("type":"SCALAR","count":6)", R"("type":"SCALAR","count":5)", "5 corners");
  refused(R"("indices":2)", R"("indices":3)", "index 3");
  refused(R"({"mesh":0})", R"({"mesh":1})", "index 1");
  refused(R"({"mesh":0})", R"({"mesh":0,"children":[0]})", "twice");
  refused(R"({"mesh":0})", R"({"mesh":0,"rotation":[0,0,0,0]})", "rotation");
  refused(R"({"mesh":0})", R"({"mesh":0,"scale":[1,2]})", "scale");
  for (size_t cut = 0; cut < whole.size(); cut += 7)
    EXPECT_THROW(read_mesh(folder.write("a.glb", whole.substr(0, cut))), InputError) << cut;
}

}  // namespace TEST_FILE
}  // namespace soapfilm
