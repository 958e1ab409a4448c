#include "soapfilm/remesh/working_mesh.h"

#include <algorithm>

namespace soapfilm {

void WorkingMesh::keep(Features found) {
  features = std::move(found);
  chain_of_edge = features.chain_of_edge;
  for (uint32_t c = 0; c < features.chains.size(); ++c) {
    const Chain& chain = features.chains[c];
    for (size_t i = 0; i < chain.vertex.size(); ++i)
      anchor[chain.vertex[i]] = features.is_corner[chain.vertex[i]] ? Anchor{Anchor::fixed, 0} : Anchor{c, chain.at[i]};
  }
}

double WorkingMesh::along(uint32_t chain, uint32_t vertex) const {
  const Chain& c = features.chains[chain];
  return vertex == c.vertex.front() ? 0 : vertex == c.vertex.back() ? c.length() : anchor[vertex].at;
}

size_t WorkingMesh::valence(uint32_t vertex) const {
  size_t count = 0;
  for_neighbors(vertex, [&](uint32_t) { ++count; });
  return count;
}

Vec3d WorkingMesh::normal(uint32_t vertex) const {
  Vec3d sum;
  mesh.for_fan(vertex, [&](uint32_t h) { sum += area_normal(corners(h / 3)); });
  return sum;
}

void WorkingMesh::grade_sizes() {
  constexpr double most_growth = 0.4;  // by length of the way
  constexpr int most_sweeps = 64;
  bool changed = true;
  for (int sweep = 0; changed && sweep < most_sweeps; ++sweep) {
    changed = false;
    for (uint32_t h = 0; h < 3 * mesh.triangles(); ++h) {
      if (!leads(h)) continue;
      const uint32_t a = mesh.from(h), b = mesh.to(h);
      const double growth = most_growth * length(h);
      for (const auto& [low, high] : {std::pair{a, b}, std::pair{b, a}})
        if (size[high] > 1.001 * (size[low] + growth)) {
          size[high] = size[low] + growth;
          changed = true;
        }
    }
  }
}

double squared_sharpness(const std::array<Vec3d, 3>& t) {
  const Vec3d ab = t[1] - t[0], bc = t[2] - t[1], ca = t[0] - t[2], n = cross(ab, ca);
  const double x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca);
  const double longer = x * y * z / std::min({x, y, z});
  return longer > 0 ? dot(n, n) / longer : 0;
}

}  // namespace soapfilm
