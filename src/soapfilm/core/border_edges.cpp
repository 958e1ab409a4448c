#include "soapfilm/core/border_edges.h"

#include <algorithm>

#include "soapfilm/core/random.h"

namespace soapfilm {

std::vector<std::pair<uint32_t, uint32_t>> edges_of_one_triangle(std::vector<std::pair<uint32_t, uint32_t>> edges) {
  std::sort(edges.begin(), edges.end());
  size_t kept = 0;
  for (size_t i = 0, next = 0; i < edges.size(); i = next) {
    for (next = i + 1; next < edges.size() && edges[next] == edges[i];) ++next;
    if (next == i + 1) edges[kept++] = edges[i];
  }
  edges.resize(kept);
  return edges;
}

bool is_closed(const Mesh& mesh) {
  uint64_t sum = 0;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const uint64_t from = t[k], to = t[(k + 1) % 3];
      sum += from < to ? Random(from << 32 | to).next() : -Random(to << 32 | from).next();
    }
  return sum == 0;
}

}  // namespace soapfilm
