#include "soapfilm/io/meshes/gltf_nodes.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "soapfilm/core/names.h"
#include "soapfilm/io/meshes/gltf_up.h"

namespace soapfilm::io {

namespace {

using nlohmann::json;

/// The numbers of a node, as many as there must be; none if they are not given.
template <size_t N>
std::optional<std::array<double, N>> numbers_of(const GlbFile& file, const json& node, const char* name) {
  const auto found = node.find(name);
  if (found == node.end()) return std::nullopt;
  std::array<double, N> numbers{};
  bool valid = found->is_array() && found->size() == N;
  for (size_t k = 0; valid && k < N; ++k) {
    valid = (*found)[k].is_number();
    if (valid) numbers[k] = (*found)[k].template get<double>();
    valid = valid && std::isfinite(numbers[k]);
  }
  if (!valid) file.fail(fmt::format("a node's {}: must be {} finite numbers", name, N));
  return numbers;
}

GltfPlace place_of(const GlbFile& file, const json& node) {
  GltfPlace place;
  if (const auto m = numbers_of<16>(file, node, "matrix")) {  // column after column
    for (size_t k = 0; k < 3; ++k) place.axis[k] = {(*m)[4 * k], (*m)[4 * k + 1], (*m)[4 * k + 2]};
    place.shift = {(*m)[12], (*m)[13], (*m)[14]};
    return place;
  }
  if (const auto q = numbers_of<4>(file, node, "rotation")) {
    const auto [qx, qy, qz, qw] = *q;
    const double length = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
    if (!(length > 0)) file.fail("a node's rotation: must be a quaternion of length 1");
    const double x = qx / length, y = qy / length, z = qz / length, w = qw / length;
    place.axis[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
    place.axis[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
    place.axis[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  }
  if (const auto s = numbers_of<3>(file, node, "scale"))
    for (size_t k = 0; k < 3; ++k) place.axis[k] = (*s)[k] * place.axis[k];
  if (const auto t = numbers_of<3>(file, node, "translation")) place.shift = {(*t)[0], (*t)[1], (*t)[2]};
  return place;
}

/// Indices in a list of a node or a scene.
std::vector<uint64_t> indices_of(const GlbFile& file, const json& object, const char* name) {
  std::vector<uint64_t> indices;
  const auto found = object.find(name);
  if (found == object.end() || !found->is_array()) return indices;
  for (const json& index : *found) {
    if (!index.is_number_unsigned() || index.get<uint64_t>() >= file.count("nodes"))
      file.fail(fmt::format("{}: must be indices of nodes below {}", name, file.count("nodes")));
    indices.push_back(index.get<uint64_t>());
  }
  return indices;
}

std::vector<uint64_t> root_nodes(const GlbFile& file) {
  if (file.count("scenes") > 0)
    return indices_of(file, file.element("scenes", file.number(file.head(), "scene", 0)), "nodes");
  std::vector<bool> is_child(file.count("nodes"));
  for (size_t k = 0; k < is_child.size(); ++k)
    for (const uint64_t child : indices_of(file, file.element("nodes", k), "children")) is_child[child] = true;
  std::vector<uint64_t> roots;
  for (size_t k = 0; k < is_child.size(); ++k)
    if (!is_child[k]) roots.push_back(k);
  return roots;
}

/// What takes the file's frame back to that of the mesh that was written.
GltfPlace frame_of(const GlbFile& file) {
  const auto asset = file.head().find("asset");
  if (asset == file.head().end() || !asset->is_object() || !asset->contains("extras")) return {};
  const json& extras = (*asset)["extras"];
  if (!extras.is_object() || !extras.contains(gltf_up_key)) return {};
  for (size_t axis = 0; axis < names_of<Axis>.size(); ++axis)
    if (extras[gltf_up_key] == names_of<Axis>[axis]) return turned_back(static_cast<Axis>(axis));
  return {};
}

}  // namespace

Vec3d GltfPlace::normal(const Vec3d& n) const {
  const Vec3d turned = n.x * cross(axis[1], axis[2]) + n.y * cross(axis[2], axis[0]) + n.z * cross(axis[0], axis[1]);
  return normalized(mirrors() ? -turned : turned);
}

GltfPlace GltfPlace::after(const GltfPlace& inner) const {
  GltfPlace both;
  for (size_t k = 0; k < 3; ++k) both.axis[k] = vector(inner.axis[k]);
  both.shift = point(inner.shift);
  return both;
}

std::vector<GltfNode> gltf_nodes(const GlbFile& file) {
  std::vector<GltfNode> shown;
  if (file.count("nodes") == 0) {
    for (size_t mesh = 0; mesh < file.count("meshes"); ++mesh) shown.push_back({mesh, {}});
    return shown;
  }
  std::vector<bool> seen(file.count("nodes"));
  std::vector<std::pair<uint64_t, GltfPlace>> open;
  const auto add_all = [&](const std::vector<uint64_t>& nodes, const GltfPlace& place) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) open.emplace_back(*node, place);
  };
  add_all(root_nodes(file), frame_of(file));
  while (!open.empty()) {
    const auto [index, outer] = open.back();
    open.pop_back();
    if (seen[index]) file.fail(fmt::format("nodes[{}] is there twice, must be the child of one node", index));
    seen[index] = true;
    const json& node = file.element("nodes", index);
    const GltfPlace place = outer.after(place_of(file, node));
    if (node.contains("mesh")) shown.push_back({file.number(node, "mesh", 0), place});
    add_all(indices_of(file, node, "children"), place);
  }
  return shown;
}

}  // namespace soapfilm::io
