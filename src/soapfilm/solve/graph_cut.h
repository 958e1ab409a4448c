// Global shape fitting by one minimum cut (Lempitsky and Boykov 2007), the paper's [16]:
//
//   min over binary u of  sum over links of w |u_i - u_j| - <f, u>,   u = 0 at fixed vertices
//
// with the same f as `tv` and links to 6 or 26 neighbors. Exact, but its measure of area depends on direction.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/band_graph.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

struct GraphCutReport {
  size_t vertices = 0;  ///< of the last cut's graph
  size_t links = 0;     ///< between them, each counted once
  int growths = 0;      ///< of the band, each followed by another cut
  double flow = 0;
  double energy = 0;       ///< of the labels: the minimum
  size_t graph_bytes = 0;  ///< of the largest graph, search trees included
  double seconds = 0;
  bool globally_optimal = false;  ///< all labels at the band's boundary agree, for each outside part
};

/// A graph's links and their weights. cauchy_crofton: the solid angle of the directions nearest to the link, over its
/// length: with 26 neighbors the cost of a plane deviates from its mean by 1.6 % (root mean square; edge_length: 1.8
/// %), with 6 by 10 % for any weights.
struct GraphCutSetup {
  int neighbors = 6;  ///< 6 or 26
  LinkWeights weights = LinkWeights::edge_length;
  /// Sets the scale: the mean cost of a unit area over its directions is lambda times mean_area(norm). So with the
  /// anisotropic norm and 6 neighbors a link costs lambda, and the energy is that of `tv` with that norm.
  Norm norm = Norm::isotropic;
};

/// The memory of a graph per vertex: 12 bytes per edge, two edges to the terminals, and the search trees. A band around
/// samples has fewer links than `neighbors`, which its vertices inside a grown band all have.
constexpr uint64_t graph_bytes_per_vertex(int neighbors, bool grown) {
  return neighbors == 6 ? (grown ? 122 : 117) : (grown ? 365 : 345);
}
/// Vertices with f != 0 and those around them fill more than half of the support's bricks.
inline constexpr double graph_vertices_per_brick = 0.58 * brick_volume;
/// Masks of the box's vertices, beside the graph: bytes per brick.
inline constexpr double graph_masks_per_brick = 2 * brick_area;

/// Of a graph that grows: twice as many links, capped before it overflows, as no path is that long.
constexpr int twice_the_reach(int reach) { return 2 * std::min(reach, 1 << 29); }

/// All links of a vertex, in an order in which the opposite of link d is link size() - 1 - d.
/// Throws ParameterError when neighbors is neither 6 nor 26 or lambda <= 0.
std::vector<Link> graph_links(const GraphCutSetup& params, double lambda);

/// The global optimum on the whole finest level. The graph holds the vertices with f != 0 and one layer around them,
/// without links to other vertices. That gives a lower bound, which the labels reach if each outside part can take the
/// label of its whole boundary with the band. Where the boundary of a part disagrees the graph grows between its two
/// labels and is cut again. The returned level has binary u, p = 0 and the norm of the parameters. `support` must
/// outlive it. `begins` is told each graph's vertices before the graph is made; it may throw. The cut uses one thread.
/// Throws ParameterError as above and if the graph has more than 2^32 edges.
Level solve_graph_cut(const Lattice& lattice, const SupportField& support, double lambda, const GraphCutSetup& params,
                      const Context& context, GraphCutReport& report,
                      const std::function<void(size_t vertices)>& begins = {});

}  // namespace soapfilm
