#include "soapfilm/io/meshes/gltf.h"

#include <fmt/format.h>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <ostream>
#include <utility>
#include <vector>

#include "soapfilm/core/border_edges.h"
#include "soapfilm/core/names.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/bytes/file_buffer.h"
#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/io/meshes/gltf_up.h"
#include "soapfilm/io/precision.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_bytes = UINT32_MAX;  // a GLB file counts its bytes in 32 bits

/// A glTF scene of one mesh, its arrays one after the other in one buffer.
class GltfScene {
 public:
  GltfScene() {
    model.asset.version = "2.0";
    model.asset.generator = "soapfilm";
    model.buffers.emplace_back();
    model.scenes.emplace_back().nodes = {0};
    model.defaultScene = 0;
    model.nodes.emplace_back().mesh = 0;
    tinygltf::Primitive& triangles = model.meshes.emplace_back().primitives.emplace_back();
    triangles.mode = TINYGLTF_MODE_TRIANGLES;
    triangles.material = 0;
    model.materials.emplace_back();
  }

  /// value(i) for each element; returns the accessor's index. Elements are a multiple of 4 bytes long.
  template <class Value>
  int add(size_t count, int component, int type, int target, Value&& value) {
    std::vector<unsigned char>& bytes = model.buffers[0].data;
    const size_t begin = bytes.size(), size = sizeof(value(0));
    bytes.resize(begin + count * size);
    for (size_t i = 0; i < count; ++i) {
      const auto element = value(i);
      std::memcpy(bytes.data() + begin + i * size, &element, size);
    }
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = begin;
    view.byteLength = count * size;
    view.target = target;
    model.bufferViews.push_back(std::move(view));
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    accessor.normalized = component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    model.accessors.push_back(std::move(accessor));
    return static_cast<int>(model.accessors.size()) - 1;
  }

  /// A node above the mesh's turns `up` to y; the head says so.
  void turn(Axis up) {
    if (up == Axis::y) return;
    const GltfPlace place = turned_up(up);
    tinygltf::Node& root = model.nodes.emplace_back();
    for (const Vec3d& image : place.axis) root.matrix.insert(root.matrix.end(), {image.x, image.y, image.z, 0});
    root.matrix.insert(root.matrix.end(), {0, 0, 0, 1});
    root.children = {0};
    model.scenes[0].nodes = {1};
    tinygltf::Value::Object extras;
    extras[gltf_up_key] = tinygltf::Value(std::string(name_of(up)));
    model.asset.extras = tinygltf::Value(std::move(extras));
  }

  tinygltf::Primitive& primitive() { return model.meshes[0].primitives[0]; }

  tinygltf::Model model;
};

/// "scan angle" as "_SCAN_ANGLE": glTF's names of further attributes.
std::string gltf_name(const std::string& name) {
  std::string text = "_";
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    text += std::isalnum(byte) ? static_cast<char>(std::toupper(byte)) : '_';
  }
  return text;
}

/// Unit vectors, as glTF demands: the mesh's own, or its faces'; up where there is none.
std::vector<Vec3f> gltf_normals(const Mesh& mesh) {
  std::vector<Vec3f> normals = mesh.normals;
  if (normals.empty()) {
    FaceNormals faces(mesh.vertices);
    for (const Triangle& triangle : mesh.triangles) faces.add(triangle);
    normals = faces.finish();
  }
  for (Vec3f& n : normals) {
    constexpr double unit = 1e-4;  // nearer to it stays as it is
    const auto exact = static_cast<Vec3d>(n);
    const double length = norm(exact);
    if (std::abs(length - 1) <= unit) continue;
    n = length > 0 && std::isfinite(length) ? static_cast<Vec3f>(exact / length) : Vec3f{0, 0, 1};
  }
  return normals;
}

/// Rough and not metallic; colors of vertices are shown as they are. Both sides of a surface that ends are seen.
void set_material(const Mesh& mesh, tinygltf::Material& material) {
  const double shade = mesh.colors.empty() ? 0.8 : 1.0;
  material.name = "surface";
  material.doubleSided = !border_edges(mesh, [](uint32_t) { return true; }).empty();
  material.pbrMetallicRoughness.baseColorFactor = {shade, shade, shade, 1};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.9;
}

void add_vertices(const Mesh& mesh, Vec3d origin, GltfScene& scene) {
  const size_t count = mesh.vertices.size();
  const auto local = [&](size_t i) { return static_cast<Vec3f>(mesh.vertices[i] - origin); };
  auto& attributes = scene.primitive().attributes;
  constexpr int vertices = TINYGLTF_TARGET_ARRAY_BUFFER, floats = TINYGLTF_COMPONENT_TYPE_FLOAT;
  const int positions = scene.add(count, floats, TINYGLTF_TYPE_VEC3, vertices, local);
  attributes["POSITION"] = positions;
  Box3d box;
  for (size_t i = 0; i < count; ++i) box.extend(static_cast<Vec3d>(local(i)));
  scene.model.accessors[static_cast<size_t>(positions)].minValues = {box.lo.x, box.lo.y, box.lo.z};
  scene.model.accessors[static_cast<size_t>(positions)].maxValues = {box.hi.x, box.hi.y, box.hi.z};
  const std::vector<Vec3f> normals = gltf_normals(mesh);
  attributes["NORMAL"] = scene.add(count, floats, TINYGLTF_TYPE_VEC3, vertices, [&](size_t i) { return normals[i]; });
  if (!mesh.colors.empty())
    attributes["COLOR_0"] =
        scene.add(count, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_VEC4, vertices, [&](size_t i) {
          const Rgb8& c = mesh.colors[i];
          return std::array<uint8_t, 4>{c[0], c[1], c[2], 255};
        });
  for (const Column& attribute : mesh.attributes)
    attributes[gltf_name(attribute.name)] = scene.add(count, floats, TINYGLTF_TYPE_SCALAR, vertices, [&](size_t i) {
      return std::isfinite(attribute.values[i]) ? attribute.values[i] : 0;
    });
}

/// Names of attributes with values that glTF does not allow.
std::string not_finite(const Mesh& mesh) {
  std::string names;
  for (const Column& attribute : mesh.attributes)
    if (!std::all_of(attribute.values.begin(), attribute.values.end(), [](float v) { return std::isfinite(v); }))
      names += (names.empty() ? "" : ", ") + attribute.name;
  return names;
}

}  // namespace

WriteReport write_glb(const std::string& path, const Mesh& mesh, const WriteOptions& options, const Context&) {
  check_mesh(mesh);
  const size_t vertex_bytes = 24 + 4 * !mesh.colors.empty() + 4 * mesh.attributes.size();
  if (mesh.vertices.size() > most_bytes / vertex_bytes ||
      mesh.triangles.size() > (most_bytes / 2 - mesh.vertices.size() * vertex_bytes / 2) / 6)
    throw OutputError(fmt::format("{}: the mesh has {} triangles, too many for the 4 GiB of a GLB file; PLY holds them",
                                  path, mesh.triangles.size()));
  const Vec3d origin = mesh.box().center();
  check_float_range(path, "glTF", mesh, origin);
  GltfScene scene;
  add_vertices(mesh, origin, scene);
  scene.model.nodes[0].translation = {origin.x, origin.y, origin.z};
  scene.turn(options.up);
  set_material(mesh, scene.model.materials[0]);
  scene.primitive().indices =
      scene.add(mesh.triangles.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](size_t i) { return mesh.triangles[i]; });
  scene.model.accessors.back().count *= 3;

  AtomicFile file(path);
  FileBuffer buffer(file);
  std::ostream stream(&buffer);
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&scene.model, stream, false, true) || !stream)
    throw OutputError(path + ": cannot be written");
  file.commit();

  WriteReport report;
  report.format = "glTF 2.0, binary";
  const double loss = float_rounding_error(mesh.vertices, origin);
  const double precision = mesh_precision(mesh, options.coordinate_precision);
  const size_t collapsed = collapsed_by_float(mesh, origin);
  if (loss > precision || collapsed > 0)
    report.warnings.push_back(fmt::format(
        "{}: glTF has 32-bit coordinates: vertices moved by up to {:.2g}, {} triangles lost all area; PLY keeps them",
        path, loss, collapsed));
  if (const std::string names = not_finite(mesh); !names.empty())
    report.warnings.push_back(path + ": glTF has no not-a-number: 0 was written in its place for attribute " + names);
  return report;
}

}  // namespace soapfilm::io
