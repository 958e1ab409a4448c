// Meshes as binary glTF, read back by the library that other programs use.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

#include <cstring>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

tinygltf::Model loaded(const std::string& path) {
  tinygltf::Model model;
  std::string error, warning;
  EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, path)) << error;
  EXPECT_EQ(error + warning, "");
  return model;
}

/// The bytes of an accessor as values of T.
template <class T>
std::vector<T> elements(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<size_t>(index));
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<size_t>(accessor.bufferView));
  const auto& bytes = model.buffers.at(static_cast<size_t>(view.buffer)).data;
  EXPECT_EQ(view.byteOffset % 4, 0u);
  EXPECT_LE(view.byteOffset + view.byteLength, bytes.size());
  std::vector<T> values(view.byteLength / sizeof(T));
  std::memcpy(values.data(), bytes.data() + view.byteOffset, view.byteLength);
  return values;
}

TEST(Glb, RefusesWhatFloatCannotHold) {
  const TemporaryFolder folder;
  for (const double size : {1e60, 1e-60})
    expect_refusal<OutputError>([&] { write_mesh(folder / "m.glb", torus_mesh(8, size)); },
                                {"m.glb", "largest coordinate", "unit"});
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Glb, HoldsTheMeshInALocalFrame) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(20, 1.0);
  const Vec3d offset{500000, 4649000, 120};
  for (Vec3d& v : mesh.vertices) v = v + offset;
  const WriteReport written = write_mesh(folder / "m.glb", mesh);
  EXPECT_TRUE(written.warnings.empty());
  const tinygltf::Model model = loaded(folder / "m.glb");
  ASSERT_EQ(model.meshes.size(), 1u);
  const tinygltf::Primitive& primitive = model.meshes[0].primitives.at(0);
  const std::vector<double>& t = model.nodes.at(0).translation;
  ASSERT_EQ(t.size(), 3u);

  const int positions = primitive.attributes.at("POSITION");
  const auto local = elements<Vec3f>(model, positions);
  ASSERT_EQ(local.size(), mesh.vertices.size());
  Box3d box;
  for (size_t i = 0; i < local.size(); ++i) {
    const Vec3d at = static_cast<Vec3d>(local[i]) + Vec3d{t[0], t[1], t[2]};
    EXPECT_LT(norm(at - mesh.vertices[i]), 1e-6);
    box.extend(static_cast<Vec3d>(local[i]));
  }
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<size_t>(positions));
  EXPECT_EQ(accessor.count, mesh.vertices.size());
  EXPECT_EQ(accessor.minValues, (std::vector<double>{box.lo.x, box.lo.y, box.lo.z}));
  EXPECT_EQ(accessor.maxValues, (std::vector<double>{box.hi.x, box.hi.y, box.hi.z}));

  const auto corners = elements<uint32_t>(model, primitive.indices);
  ASSERT_EQ(corners.size(), 3 * mesh.triangles.size());
  EXPECT_EQ(model.accessors.at(static_cast<size_t>(primitive.indices)).count, corners.size());
  EXPECT_EQ(std::memcmp(corners.data(), mesh.triangles.data(), corners.size() * sizeof(uint32_t)), 0);
  const auto colors = elements<std::array<uint8_t, 4>>(model, primitive.attributes.at("COLOR_0"));
  ASSERT_EQ(colors.size(), mesh.colors.size());
  for (size_t i = 0; i < colors.size(); ++i)
    EXPECT_EQ((Rgb8{colors[i][0], colors[i][1], colors[i][2]}), mesh.colors[i]);
  EXPECT_EQ(elements<Vec3f>(model, primitive.attributes.at("NORMAL")), mesh.normals);
  EXPECT_EQ(elements<float>(model, primitive.attributes.at("_HEIGHT")), mesh.attributes[0].values);
}

/// The vertices as a viewer places them: by the root's matrix and the mesh node's translation.
std::vector<Vec3d> placed(const tinygltf::Model& model) {
  const tinygltf::Node& root = model.nodes.at(static_cast<size_t>(model.scenes.at(0).nodes.at(0)));
  const tinygltf::Node& node = root.children.empty() ? root : model.nodes.at(static_cast<size_t>(root.children[0]));
  const std::vector<double>&m = root.matrix, &t = node.translation;
  std::vector<Vec3d> vertices;
  for (const Vec3f& v : elements<Vec3f>(model, model.meshes.at(0).primitives.at(0).attributes.at("POSITION"))) {
    const double p[3] = {double{v.x} + t[0], double{v.y} + t[1], double{v.z} + t[2]};
    Vec3d& out = vertices.emplace_back();
    for (int k = 0; k < 3; ++k) out[k] = m.empty() ? p[k] : m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2];
  }
  return vertices;
}

class GlbUp : public testing::TestWithParam<Axis> {};

TEST_P(GlbUp, IsTurnedToYAndBackWithoutMirroring) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(20, 1.0);
  for (Vec3d& v : mesh.vertices) v = v + Vec3d{3, 40, 500};
  WriteOptions options;
  options.up = GetParam();
  write_mesh(folder / "m.glb", mesh, options);
  const std::vector<Vec3d> shown = placed(loaded(folder / "m.glb"));
  const int axis = static_cast<int>(GetParam()) % 3;
  const double sign = static_cast<int>(GetParam()) < 3 ? 1 : -1;
  Mesh turned = mesh;
  for (size_t i = 0; i < shown.size(); ++i) {
    EXPECT_NEAR(shown[i].y, sign * mesh.vertices[i][axis], 1e-5);
    EXPECT_NEAR(norm(shown[i]), norm(mesh.vertices[i]), 1e-4);
    turned.vertices[i] = shown[i];
  }
  EXPECT_NEAR(turned.volume(), mesh.volume(), 1e-5);  // positive: not mirrored

  const Mesh read = read_mesh(folder / "m.glb");
  for (size_t i = 0; i < shown.size(); ++i) {
    EXPECT_LT(norm(read.vertices[i] - mesh.vertices[i]), 1e-6);
    EXPECT_LT(norm(read.normals[i] - mesh.normals[i]), 1e-6F);
  }
  write_mesh(folder / "again.glb", read, options);
  EXPECT_EQ(read_mesh(folder / "again.glb").vertices, read.vertices);
}

INSTANTIATE_TEST_SUITE_P(Axes, GlbUp,
                         testing::Values(Axis::x, Axis::y, Axis::z, Axis::minus_x, Axis::minus_y, Axis::minus_z));

TEST(Glb, ZIsUpUnlessItIsSaid) {
  const TemporaryFolder folder;
  const Mesh mesh = torus_mesh(10, 1.0);
  write_mesh(folder / "m.glb", mesh);
  const std::vector<Vec3d> shown = placed(loaded(folder / "m.glb"));
  for (size_t i = 0; i < shown.size(); ++i) EXPECT_NEAR(shown[i].y, mesh.vertices[i].z, 1e-6);
}

TEST(Glb, NormalsOfTheFacesWhereTheMeshHasNoneAlwaysOfUnitLength) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(40, 1.0);
  const std::vector<Vec3f> smooth = mesh.normals;
  mesh.normals.clear();
  mesh.vertices.push_back({0, 0, 0});  // in no triangle
  mesh.colors.clear();
  mesh.attributes.clear();
  write_mesh(folder / "m.glb", mesh);
  const tinygltf::Model model = loaded(folder / "m.glb");
  const auto normals = elements<Vec3f>(model, model.meshes[0].primitives[0].attributes.at("NORMAL"));
  ASSERT_EQ(normals.size(), mesh.vertices.size());
  for (const Vec3f& n : normals) EXPECT_NEAR(norm(n), 1, 1e-4);
  for (size_t i = 0; i < smooth.size(); ++i) EXPECT_GT(dot(normals[i], smooth[i]), 0.98F);
}

TEST(Glb, TheMaterialIsSeenFromBothSidesWhereTheSurfaceEnds) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(10, 1.0);
  write_mesh(folder / "closed.glb", mesh);
  mesh.triangles.pop_back();
  write_mesh(folder / "open.glb", mesh);
  for (const bool open : {false, true}) {
    const tinygltf::Model model = loaded(folder / (open ? "open.glb" : "closed.glb"));
    ASSERT_EQ(model.materials.size(), 1u);
    EXPECT_EQ(model.meshes[0].primitives[0].material, 0);
    EXPECT_EQ(model.materials[0].doubleSided, open);
    EXPECT_EQ(model.materials[0].pbrMetallicRoughness.metallicFactor, 0);
  }
}

TEST(Glb, SaysWhatItCannotHold) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(10, 1.0);
  mesh.attributes[0].values[3] = std::numeric_limits<float>::quiet_NaN();
  const WriteReport written = write_mesh(folder / "m.glb", mesh);
  ASSERT_EQ(written.warnings.size(), 1u);
  EXPECT_NE(written.warnings[0].find(mesh.attributes[0].name), std::string::npos);
  const tinygltf::Model model = loaded(folder / "m.glb");
  EXPECT_EQ(elements<float>(model, model.meshes[0].primitives[0].attributes.at("_HEIGHT"))[3], 0);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
