// The edges at which a surface ends.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm {

/// Of these edges, given once by each triangle that has them with the smaller vertex first, those of one triangle
/// alone, sorted.
std::vector<std::pair<uint32_t, uint32_t>> edges_of_one_triangle(std::vector<std::pair<uint32_t, uint32_t>> edges);

/// The edges of a mesh that one triangle alone has, the smaller vertex first, sorted: of those with an end for which
/// counts(vertex) is true.
template <class Counts>
std::vector<std::pair<uint32_t, uint32_t>> border_edges(const Mesh& mesh, Counts&& counts) {
  const auto visit = [&](auto&& edge) {
    for (const Triangle& t : mesh.triangles)
      for (size_t k = 0; k < 3; ++k)
        if (const uint32_t a = t[k], b = t[(k + 1) % 3]; counts(a) || counts(b)) edge(std::min(a, b), std::max(a, b));
  };
  size_t count = 0;
  visit([&](uint32_t, uint32_t) { ++count; });
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  edges.reserve(count);  // no more memory than they take
  visit([&](uint32_t a, uint32_t b) { edges.emplace_back(a, b); });
  return edges_of_one_triangle(std::move(edges));
}

/// Does each edge occur as often in one direction as in the other? Then the sum of random numbers of the edges, of
/// either sign, is zero, and only then but for a chance of 2^-64: no edges are kept or sorted.
bool is_closed(const Mesh& mesh);

}  // namespace soapfilm
