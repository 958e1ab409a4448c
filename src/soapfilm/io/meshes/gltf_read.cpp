#include "soapfilm/io/meshes/gltf_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/meshes/glb_file.h"
#include "soapfilm/io/meshes/gltf_nodes.h"
#include "soapfilm/io/meshes/mesh_points.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

using nlohmann::json;

enum GltfMode : uint64_t { gltf_points = 0, gltf_triangles = 4, gltf_strip = 5, gltf_fan = 6 };

bool has_gltf_faces(uint64_t mode) { return mode >= gltf_triangles && mode <= gltf_fan; }

/// Makes one mesh of all that a scene holds.
class GltfReader {
 public:
  GltfReader(ByteSource& source, bool is_mesh) : source_(source), file_(source), is_mesh_(is_mesh) {}

  Mesh read(ReadReport& report) {
    for (const GltfNode& node : gltf_nodes(file_)) add_mesh(node);
    if (lines_ > 0)
      report.warnings.push_back(fmt::format("{}: {} parts made of lines are not used", source_.path(), lines_));
    if (is_mesh_ && mesh_.triangles.empty()) throw InputError(source_.path() + ": holds no faces, must be a mesh");
    if (is_mesh_ && some_without_normals_) mesh_.normals.clear();
    return std::move(mesh_);
  }

  bool has_faces() const {
    bool found = false;
    for_each_primitive([&](const json& primitive) {
      found = found || has_gltf_faces(file_.number(primitive, "mode", gltf_triangles));
    });
    return found;
  }

  /// No node moves its vertices.
  bool float32() const { return float32_; }

 private:
  template <class Use>
  void for_each_primitive(uint64_t mesh, const Use& use) const {
    const json& of = file_.element("meshes", mesh);
    const auto primitives = of.find("primitives");
    if (primitives == of.end() || !primitives->is_array()) return;
    for (const json& primitive : *primitives)
      if (primitive.is_object()) use(primitive);
  }
  template <class Use>
  void for_each_primitive(const Use& use) const {
    for (size_t mesh = 0; mesh < file_.count("meshes"); ++mesh) for_each_primitive(mesh, use);
  }

  void add_mesh(const GltfNode& node) {
    float32_ = float32_ && node.place == GltfPlace();
    begins_.clear();
    for_each_primitive(node.mesh, [&](const json& primitive) {
      const uint64_t mode = file_.number(primitive, "mode", gltf_triangles);
      if (mode != gltf_points && !has_gltf_faces(mode)) {
        ++lines_;
        return;
      }
      const auto attributes = primitive.find("attributes");
      if (attributes == primitive.end() || !attributes->is_object() || !attributes->contains("POSITION"))
        file_.fail(fmt::format("meshes[{}]: a primitive has no POSITION", node.mesh));
      const size_t begin = add_vertices(*attributes, node.place);
      if (mode != gltf_points) add_faces(primitive, mode, begin, node.place.mirrors());
    });
  }

  std::optional<GltfArray> array_of(const json& attributes, const std::string& name) const {
    if (!attributes.contains(name)) return std::nullopt;
    return file_.accessor(file_.number(attributes, name.c_str(), 0));
  }

  GltfArray vectors_of(const json& attributes, const std::string& name, size_t least, size_t most, size_t count) const {
    const GltfArray array = *array_of(attributes, name);
    if (array.parts < least || array.parts > most || (count != 0 && array.count != count))
      file_.fail(fmt::format("{}: {} elements of {} numbers, must be {} of {}", name, array.count, array.parts,
                             count == 0 ? array.count : count, least));
    return array;
  }

  /// Returns where the vertices begin: arrays that several primitives share are read once.
  size_t add_vertices(const json& attributes, const GltfPlace& place) {
    const GltfArray positions = vectors_of(attributes, "POSITION", 3, 3, 0);
    const auto number = [&](const char* name) { return file_.number(attributes, name, UINT64_MAX); };
    const auto [found, is_new] =
        begins_.try_emplace({number("POSITION"), number("NORMAL"), number("COLOR_0")}, mesh_.vertices.size());
    if (!is_new) return found->second;
    check_growth(positions.count);
    const size_t begin = found->second;
    for (size_t i = 0; i < positions.count; ++i) {
      const Vec3d p = place.point({positions.value(i, 0), positions.value(i, 1), positions.value(i, 2)});
      if (is_mesh_ && !is_finite(p)) file_.fail(fmt::format("POSITION {}: must be finite", i));
      mesh_.vertices.push_back(p);
    }
    add_normals(attributes, place, begin);
    add_colors(attributes, begin);
    add_columns(attributes, begin);
    return begin;
  }

  void add_normals(const json& attributes, const GltfPlace& place, size_t begin) {
    const size_t count = mesh_.vertices.size() - begin;
    if (!attributes.contains("NORMAL")) {
      some_without_normals_ = true;
      if (!mesh_.normals.empty()) mesh_.normals.resize(mesh_.vertices.size());
      return;
    }
    const GltfArray normals = vectors_of(attributes, "NORMAL", 3, 3, count);
    mesh_.normals.resize(begin);
    for (size_t i = 0; i < count; ++i)
      mesh_.normals.push_back(
          static_cast<Vec3f>(place.normal({normals.value(i, 0), normals.value(i, 1), normals.value(i, 2)})));
  }

  /// Colors are bytes, or numbers to 1; they are in linear light where programs keep to the letter, but most do not.
  void add_colors(const json& attributes, size_t begin) {
    constexpr Rgb8 gray{128, 128, 128};
    const size_t count = mesh_.vertices.size() - begin;
    if (!attributes.contains("COLOR_0")) {
      if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.vertices.size(), gray);
      return;
    }
    GltfArray colors = vectors_of(attributes, "COLOR_0", 3, 4, count);
    colors.normalized = true;
    mesh_.colors.resize(begin, gray);
    for (size_t i = 0; i < count; ++i) {
      Rgb8 rgb{};
      for (size_t k = 0; k < 3; ++k) {
        const double value = colors.value(i, k);
        rgb[k] = value > 0 ? static_cast<uint8_t>(std::lround(255 * std::min(value, 1.0))) : uint8_t{0};
      }
      mesh_.colors.push_back(rgb);
    }
  }

  /// Attributes of the user begin with '_'; ours are written so.
  void add_columns(const json& attributes, size_t begin) {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    constexpr size_t most_columns = 1000;
    const size_t count = mesh_.vertices.size() - begin;
    for (const auto& [key, unused] : attributes.items()) {
      if (key.size() < 2 || key[0] != '_') continue;
      const GltfArray values = *array_of(attributes, key);
      if (values.parts != 1 || values.count != count) continue;
      const std::string name = lower_case(std::string_view(key).substr(1));
      const auto has_name = [&](const Column& column) { return column.name == name; };
      auto found = std::find_if(mesh_.attributes.begin(), mesh_.attributes.end(), has_name);
      if (found == mesh_.attributes.end()) {
        if (mesh_.attributes.size() == most_columns) continue;
        mesh_.attributes.push_back({name, {}});
        found = mesh_.attributes.end() - 1;
      }
      found->values.resize(begin, none);
      for (size_t i = 0; i < count; ++i) found->values.push_back(static_cast<float>(values.value(i, 0)));
    }
    for (Column& column : mesh_.attributes) column.values.resize(mesh_.vertices.size(), none);
  }

  void add_faces(const json& primitive, uint64_t mode, size_t begin, bool mirrored) {
    const size_t vertices = vertices_of(primitive);
    std::optional<GltfArray> indices;
    if (primitive.contains("indices")) {
      indices = file_.accessor(file_.number(primitive, "indices", 0));
      if (indices->parts != 1 || indices->component == GltfArray::float32 || indices->component == GltfArray::int8 ||
          indices->component == GltfArray::int16)
        file_.fail("indices: must be whole numbers >= 0");
      indices->normalized = false;
    }
    const size_t corners = indices ? indices->count : vertices;
    if (mode == gltf_triangles && corners % 3 != 0)
      file_.fail(fmt::format("triangles of {} corners, must be three each", corners));
    check_growth(corners / 3);
    const auto corner = [&](size_t i) {
      const uint32_t v = indices ? indices->index(i) : static_cast<uint32_t>(i);
      if (v >= vertices) file_.fail(fmt::format("index {}, must be below {}", v, vertices));
      return static_cast<uint32_t>(begin + v);
    };
    const auto add = [&](size_t a, size_t b, size_t c) {
      const Triangle triangle{corner(a), corner(mirrored ? c : b), corner(mirrored ? b : c)};
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
        mesh_.triangles.push_back(triangle);
    };
    if (mode == gltf_triangles)
      for (size_t i = 0; i + 2 < corners; i += 3) add(i, i + 1, i + 2);
    else
      for (size_t i = 0; i + 2 < corners; ++i)
        mode == gltf_fan ? add(0, i + 1, i + 2) : i % 2 == 0 ? add(i, i + 1, i + 2) : add(i + 1, i, i + 2);
  }

  size_t vertices_of(const json& primitive) const {
    return file_.accessor(file_.number(primitive["attributes"], "POSITION", 0)).count;
  }

  /// Nodes may show one mesh many times: far more than real files do this would be an attack.
  void check_growth(size_t more) {
    constexpr uint64_t most_growth = 4, always = uint64_t{1} << 20;
    grown_ += more;
    if (grown_ > most_growth * file_.size() + always || grown_ > INT32_MAX)
      file_.fail(fmt::format("{} vertices and triangles, must be fewer for a file of {} bytes", grown_, file_.size()));
  }

  ByteSource& source_;
  GlbFile file_;
  bool is_mesh_;
  Mesh mesh_;
  std::map<std::array<uint64_t, 3>, size_t> begins_;  // of a node's mesh: the vertices of these attributes
  bool some_without_normals_ = false;
  bool float32_ = true;
  size_t lines_ = 0;
  uint64_t grown_ = 0;
};

}  // namespace

bool looks_like_glb(const ByteSource& source) { return source.begins_with("glTF"); }

bool glb_has_faces(ByteSource& source) { return GltfReader(source, false).has_faces(); }

PointCloud read_glb_points(ByteSource& source, ReadReport& report, const ReadOptions&, const Context&) {
  GltfReader reader(source, false);
  Mesh mesh = reader.read(report);
  return points_of_mesh(std::move(mesh), source, "glTF 2.0, binary", reader.float32(), report);
}

Mesh read_glb_mesh(ByteSource& source, ReadReport& report) { return GltfReader(source, true).read(report); }

}  // namespace soapfilm::io
