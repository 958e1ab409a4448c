// The leaves of all levels cut as one graph (solve/graph_cut.h, adapt/leaf_links.h): the global optimum on them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/grid/layout.h"
#include "soapfilm/solve/graph_cut.h"
#include "soapfilm/solve/level.h"
#include "soapfilm/solve/network.h"

namespace soapfilm {

struct LeafCutSetup {
  GraphCutSetup graph;
  double lambda = 1;  ///< of the placed level
  /// Is told each graph's leaves, and the bytes of what goes with them, before it is made: whether they fit. Empty: all
  /// do.
  std::function<bool(size_t leaves, uint64_t beside)> fits;
};

/// The memory of the graph per leaf, and of what surrounds it per leaf brick: sets of leaves, and parts of bricks that
/// the graph has in part.
constexpr uint64_t leaf_graph_bytes(int neighbors) { return network_bytes_per_vertex(neighbors); }
inline constexpr uint64_t leaf_brick_bytes = 8 * brick_area, mixed_brick_bytes = 5 * brick_volume;

/// One level for each of the regions', the finest first: u is 0 or 1, p = 0, in bricks with finer leaves u is that of
/// most of them; on bricks near the surface and those of the data. The graph holds the leaves with f != 0 and those
/// linked to them, and grows where the labels do not say which side the leaves around it are on, as on one grid
/// (solve/graph_cut.h). Only of closed boxes. `data`: as of data_of_leaves(), must outlive the levels. None if a graph
/// does not fit. The cut uses one thread. Throws ParameterError as solve_graph_cut() does.
std::optional<std::vector<Level>> cut_leaves(const Regions& regions, const Lattice& lattice,
                                             std::span<const SupportField> data, const LeafCutSetup& how,
                                             const Context& context, GraphCutReport& report);

}  // namespace soapfilm
