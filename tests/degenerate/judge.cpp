#include "judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "support/process.h"

namespace soapfilm::test {

namespace {

template <class T>
T number_at(const std::string& bytes, size_t at) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) throw std::runtime_error("GLB ends early");
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// One mesh of one primitive, below a node that moves it.
Mesh read_glb(const std::string& path) {
  const std::string bytes = read_file(path);
  const auto json_size = number_at<uint32_t>(bytes, 12);
  const auto json = nlohmann::json::parse(bytes.substr(20, json_size));
  const size_t binary = 20 + size_t{json_size} + 8;
  if (number_at<uint32_t>(bytes, 8) != bytes.size()) throw std::runtime_error("GLB of another length than it says");
  const auto& primitive = json["meshes"][0]["primitives"][0];
  const auto begin = [&](const nlohmann::json& accessor) {
    const auto& view = json["bufferViews"][accessor["bufferView"].get<size_t>()];
    return binary + view.value("byteOffset", size_t{0}) + accessor.value("byteOffset", size_t{0});
  };
  Mesh mesh;
  const auto& positions = json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()];
  for (size_t i = 0; i < positions["count"].get<size_t>(); ++i) {
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = number_at<float>(bytes, begin(positions) + 12 * i + 4 * static_cast<size_t>(k));
    mesh.vertices.push_back(p);
  }
  const auto& indices = json["accessors"][primitive["indices"].get<size_t>()];
  if (indices["componentType"] != 5125) throw std::runtime_error("GLB whose indices are not uint32");
  for (size_t i = 0; i < indices["count"].get<size_t>() / 3; ++i) {
    const auto index = [&](size_t k) { return number_at<uint32_t>(bytes, begin(indices) + 12 * i + 4 * k); };
    mesh.triangles.push_back({index(0), index(1), index(2)});
  }
  return mesh;
}

/// Triangles at each vertex: from the next of its other two corners to the last.
using Fans = std::vector<std::map<uint32_t, uint32_t>>;

/// Whether the triangles at a vertex are one chain or one ring.
bool is_one_fan(const std::map<uint32_t, uint32_t>& fan) {
  std::map<uint32_t, int> entered;
  for (const auto& [from, to] : fan) ++entered[to];
  uint32_t start = fan.begin()->first;
  for (const auto& [from, to] : fan)
    if (!entered.contains(from)) start = from;
  size_t steps = 0;
  for (auto at = fan.find(start); at != fan.end() && steps <= fan.size(); at = fan.find(at->second)) {
    ++steps;
    if (at->second == start) break;
  }
  return steps == fan.size();
}

std::string broken_triangle_law(const Mesh& mesh, size_t t) {
  const Triangle& corners = mesh.triangles[t];
  for (const uint32_t v : corners)
    if (v >= mesh.vertices.size()) return fmt::format("triangle {} names no vertex", t);
  const Vec3d a = mesh.vertices[corners[0]], b = mesh.vertices[corners[1]], c = mesh.vertices[corners[2]];
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  // Scaled first: squares of tiny or huge lengths would leave double's range.
  const double area = longest > 0 ? norm(cross((b - a) / longest, (c - a) / longest)) : 0;
  return area > 1e-12 ? "" : fmt::format("triangle {} has no area: height {} of its longest side {}", t, area, longest);
}

}  // namespace

Mesh read_written(const std::string& path) { return path.ends_with(".glb") ? read_glb(path) : read_mesh(path); }

std::string broken_mesh_law(const Mesh& mesh, bool may_end, bool one_fan) {
  if (mesh.triangles.empty()) return "no triangles";
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!is_finite(mesh.vertices[v])) return fmt::format("vertex {} is not finite", v);
  Fans fans(mesh.vertices.size());
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (std::string broken = broken_triangle_law(mesh, t); !broken.empty()) return broken;
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = mesh.triangles[t][k], from = mesh.triangles[t][(k + 1) % 3],
                     to = mesh.triangles[t][(k + 2) % 3];
      if (++edges[{v, from}] > 1) return fmt::format("edge {} {} has two triangles on one side", v, from);
      fans[v][from] = to;
    }
  }
  for (const auto& [edge, count] : edges)
    if (!may_end && !edges.contains({edge.second, edge.first}))
      return fmt::format("edge {} {} is a border", edge.first, edge.second);
  for (size_t v = 0; v < fans.size(); ++v) {
    if (fans[v].empty()) return fmt::format("vertex {} has no triangle", v);
    if (one_fan && !is_one_fan(fans[v])) return fmt::format("vertex {} has several fans", v);
  }
  return "";
}

}  // namespace soapfilm::test
