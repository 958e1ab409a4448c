#include "soapfilm/core/border_edges.h"

#include <algorithm>

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

}  // namespace soapfilm
