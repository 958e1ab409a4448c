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
#include <span>
#include <utility>
#include <vector>

#include "soapfilm/core/border_edges.h"
#include "soapfilm/core/names.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/bytes/file_buffer.h"
#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/io/meshes/gltf_up.h"
#include "soapfilm/io/precision.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_bytes = UINT32_MAX;  // a GLB file counts its bytes in 32 bits

/// A glTF scene that shows the first of its meshes, their arrays one after the other in one buffer.
class GltfScene {
 public:
  GltfScene() {
    model.asset.version = "2.0";
    model.asset.generator = "soapfilm";
    model.buffers.emplace_back();
    model.scenes.emplace_back().nodes = {0};
    model.defaultScene = 0;
    model.materials.emplace_back();
  }

  /// A mesh and its node.
  void begin_mesh(Vec3d origin) {
    tinygltf::Node& node = model.nodes.emplace_back();
    node.mesh = static_cast<int>(model.meshes.size());
    node.translation = {origin.x, origin.y, origin.z};
    tinygltf::Primitive& triangles = model.meshes.emplace_back().primitives.emplace_back();
    triangles.mode = TINYGLTF_MODE_TRIANGLES;
    triangles.material = 0;
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
    model.scenes[0].nodes = {static_cast<int>(model.nodes.size())};
    tinygltf::Node& root = model.nodes.emplace_back();
    for (const Vec3d& image : place.axis) root.matrix.insert(root.matrix.end(), {image.x, image.y, image.z, 0});
    root.matrix.insert(root.matrix.end(), {0, 0, 0, 1});
    root.children = {0};
    tinygltf::Value::Object extras;
    extras[gltf_up_key] = tinygltf::Value(std::string(name_of(up)));
    model.asset.extras = tinygltf::Value(std::move(extras));
  }

  tinygltf::Primitive& primitive() { return model.meshes.back().primitives[0]; }

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

void check_size(const std::string& path, std::span<const Mesh* const> meshes) {
  size_t triangles = 0, room = most_bytes;
  bool fits = true;
  for (const Mesh* mesh : meshes) {
    const size_t vertex_bytes = 24 + 4 * !mesh->colors.empty() + 4 * mesh->attributes.size();
    triangles += mesh->triangles.size();
    fits = fits && mesh->vertices.size() <= room / vertex_bytes;
    if (fits) room -= mesh->vertices.size() * vertex_bytes;
    fits = fits && mesh->triangles.size() <= room / sizeof(Triangle);
    if (fits) room -= mesh->triangles.size() * sizeof(Triangle);
  }
  if (!fits)
    throw OutputError(fmt::format("{}: the mesh has {} triangles, too many for the 4 GiB of a GLB file; PLY holds them",
                                  path, triangles));
}

void add_mesh(const Mesh& mesh, Vec3d origin, GltfScene& scene) {
  scene.begin_mesh(origin);
  add_vertices(mesh, origin, scene);
  scene.primitive().indices =
      scene.add(mesh.triangles.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](size_t i) { return mesh.triangles[i]; });
  scene.model.accessors.back().count *= 3;
}

/// The first node shows all: the extension names the others, of which the scene knows nothing.
void name_levels(std::span<const DetailLevel> levels, Vec3d origin, tinygltf::Model& model) {
  tinygltf::Value::Array others;
  for (size_t k = 0; k < levels.size(); ++k) {
    tinygltf::Node& node = model.nodes[k];
    node.name = fmt::format("lod{}", k);
    constexpr double diagonal = 1.7320508075688774;  // of the error along an axis
    const double rounding = float_rounding_error(levels[k].mesh.vertices, origin) * diagonal;
    tinygltf::Value::Object extras;
    extras["proved_distance"] = tinygltf::Value(levels[k].proved + rounding);
    node.extras = tinygltf::Value(std::move(extras));
    if (k > 0) others.emplace_back(static_cast<int>(k));
  }
  tinygltf::Value::Object lod;
  lod["ids"] = tinygltf::Value(std::move(others));
  model.nodes[0].extensions["MSFT_lod"] = tinygltf::Value(std::move(lod));
  model.extensionsUsed = {"MSFT_lod"};
}

void write_scene(AtomicFile& file, tinygltf::Model& model) {
  FileBuffer buffer(file);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios::badbit);  // the buffer's say why
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true) || !stream)
    throw OutputError(file.path() + ": cannot be written");
}

/// What the file does not hold as it was.
std::vector<std::string> losses(const std::string& path, std::span<const Mesh* const> meshes, Vec3d origin,
                                double coordinate_precision) {
  std::vector<std::string> warnings;
  double loss = 0;
  size_t collapsed = 0;
  bool matters = false;
  for (const Mesh* mesh : meshes) {
    const double moved = float_rounding_error(mesh->vertices, origin);
    matters |= moved > mesh_precision(*mesh, coordinate_precision);
    loss = std::max(loss, moved);
    collapsed += collapsed_by_float(*mesh, origin);
  }
  if (matters || collapsed > 0)
    warnings.push_back(fmt::format(
        "{}: glTF has 32-bit coordinates: vertices moved by up to {:.2g}, {} triangles lost all area; PLY keeps them",
        path, loss, collapsed));
  if (const std::string names = not_finite(*meshes[0]); !names.empty())
    warnings.push_back(path + ": glTF has no not-a-number: 0 was written in its place for attribute " + names);
  return warnings;
}

WriteReport write_meshes(AtomicFile& file, std::span<const Mesh* const> meshes, std::span<const DetailLevel> levels,
                         Vec3d origin, const WriteOptions& options) {
  for (const Mesh* mesh : meshes) check_mesh(*mesh);
  check_size(file.path(), meshes);
  GltfScene scene;
  for (const Mesh* mesh : meshes) {
    check_float_range(file.path(), "glTF", *mesh, origin);
    add_mesh(*mesh, origin, scene);
  }
  if (!levels.empty()) name_levels(levels, origin, scene.model);
  scene.turn(options.up);
  set_material(*meshes[0], scene.model.materials[0]);
  write_scene(file, scene.model);
  WriteReport report;
  report.format = "glTF 2.0, binary";
  report.warnings = losses(file.path(), meshes, origin, options.coordinate_precision);
  return report;
}

}  // namespace

WriteReport write_glb(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context&) {
  return write_glb_at(file, mesh, mesh.box().center(), options);
}

WriteReport write_glb_at(AtomicFile& file, const Mesh& mesh, Vec3d origin, const WriteOptions& options) {
  const Mesh* const meshes[] = {&mesh};
  return write_meshes(file, meshes, {}, origin, options);
}

WriteReport write_glb_levels(AtomicFile& file, std::span<const DetailLevel> levels, const WriteOptions& options) {
  std::vector<const Mesh*> meshes;
  for (const DetailLevel& level : levels) meshes.push_back(&level.mesh);
  return write_meshes(file, meshes, levels, meshes[0]->box().center(), options);
}

}  // namespace soapfilm::io
