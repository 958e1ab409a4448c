// The cheapest cut of any graph, whose links are given one by one: for neighborhoods that are not those of one grid.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/solve/min_cut.h"

namespace soapfilm {

struct NetworkVertex {
  double unary = 0;                                ///< cost of u = 1
  std::vector<std::pair<uint32_t, double>> links;  ///< to other vertices, with the cost of cutting each
};

/// Visits the vertices in the order of their numbers, each time the same. A link is given by one of its ends.
using NetworkStream = std::function<void(const std::function<void(const NetworkVertex&)>& visit)>;

/// Memory per vertex with so many links, search trees included: 16 bytes per edge, two edges to the terminals.
constexpr uint64_t network_bytes_per_vertex(int links) { return 16 * (static_cast<uint64_t>(links) + 2) + 26; }

/// As for a band's graph (solve/min_cut.h). Throws ParameterError if it has more than 2^32 edges.
MinCut min_cut(uint32_t vertices, const NetworkStream& stream, const Context& context);

}  // namespace soapfilm
