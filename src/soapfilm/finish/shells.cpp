#include "soapfilm/finish/shells.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/core/border_edges.h"
#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/extract/cut.h"

namespace soapfilm {

namespace {

struct Part {
  double area = 0, volume = 0;
  bool closed = true;
};

/// At the root of each part.
std::vector<Part> measure_parts(const Mesh& mesh, DisjointSets& sets) {
  std::vector<Part> parts(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    Part& part = parts[sets.root(t[0])];
    const Vec3d origin = mesh.vertices[sets.root(t[0])];
    const auto at = [&](size_t k) { return mesh.vertices[t[k]] - origin; };
    part.area += norm(cross(at(1) - at(0), at(2) - at(0))) / 2;
    part.volume += dot(at(0), cross(at(1), at(2))) / 6;
  }
  for (const auto& edge : border_edges(mesh, [](uint32_t) { return true; }))
    parts[sets.root(edge.first)].closed = false;
  return parts;
}

}  // namespace

size_t drop_shells(Mesh& mesh) {
  constexpr double room = 0.5;  // of the area
  DisjointSets sets(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  const std::vector<Part> parts = measure_parts(mesh, sets);
  double whole = 0;
  for (const Part& part : parts) whole += part.area;
  std::vector<uint8_t> drop(parts.size());
  size_t dropped = 0;
  for (size_t v = 0; v < parts.size(); ++v) {
    drop[v] = parts[v].closed && parts[v].volume < 0 && parts[v].area < room * whole;
    dropped += drop[v];
  }
  if (dropped > 0) keep_triangles(mesh, [&](uint32_t v) { return !drop[sets.root(v)]; });
  return dropped;
}

}  // namespace soapfilm
