// The cheapest cut of a band's graph: exact, by the augmenting paths of Boykov and Kolmogorov (2004).
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/progress.h"
#include "soapfilm/solve/band_graph.h"

namespace soapfilm {

struct MinCut {
  std::vector<bool> inside;  ///< u of each vertex, from the optimal cut with the fewest vertices inside
  double flow = 0;           ///< min of the energy plus the sum of max(0, -unary)
  size_t links = 0;          ///< between vertices, each counted once
  size_t bytes = 0;          ///< of the graph and of the search trees
};

/// Minimizes sum of unary u + sum over links of weight |u_i - u_j|, in double. One thread.
MinCut min_cut(const BandGraph& graph, const Context& context);

}  // namespace soapfilm
