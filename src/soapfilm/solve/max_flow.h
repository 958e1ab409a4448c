// The largest flow through a graph, and with it its cheapest cut, by the augmenting paths of Boykov and Kolmogorov
// (2004), Boost's. How edges are stored, reversed and followed to parents is for the graph to say.
#pragma once

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/two_bit_color_map.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/solve/min_cut.h"

namespace soapfilm {

/// The edges of a vertex are next to each other, all numbers have 32 bits.
using FlowGraph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                                     boost::no_property, uint32_t, uint32_t>;
using FlowEdge = boost::graph_traits<FlowGraph>::edge_descriptor;

// Property maps, by Boost's concepts.

/// The algorithm changes these capacities into residual ones.
struct ResidualMap {
  using key_type = FlowEdge;
  using value_type = double;
  using reference = double;
  using category = boost::read_write_property_map_tag;
  double* values;
};
inline double get(const ResidualMap& map, FlowEdge edge) { return map.values[edge.idx]; }
inline void put(const ResidualMap& map, FlowEdge edge, double value) { map.values[edge.idx] = value; }

/// Asks a context now and then whether the run is canceled. It is called for each parent that changes.
class FlowCheck {
 public:
  explicit FlowCheck(const Context& context) : context_(context) {}
  void count() {
    constexpr size_t writes_between_checks = 1 << 16;
    if (++writes_ % writes_between_checks == 0) context_.check();
  }

 private:
  const Context& context_;
  size_t writes_ = 0;
};

/// `flow` and `inside` of the cut. The graph's last two vertices, after so many others, are the source and the sink.
template <class ReverseMap, class ParentMap>
MinCut max_flow(const FlowGraph& graph, uint32_t vertices, std::vector<double>& capacities, const ReverseMap& reverse,
                const ParentMap& parent) {
  const size_t all = size_t{vertices} + 2;
  std::vector<uint32_t> distance(all);
  const auto index = boost::get(boost::vertex_index, graph);
  const boost::two_bit_color_map<decltype(index)> color(all, index);
  const ResidualMap residual{capacities.data()};
  MinCut cut;
  cut.flow = boost::boykov_kolmogorov_max_flow(graph, residual, residual, reverse, parent, color,
                                               boost::make_iterator_property_map(distance.begin(), index), index,
                                               vertices, vertices + 1);
  cut.inside.resize(vertices);
  for (uint32_t v = 0; v < vertices; ++v) cut.inside[v] = get(color, v) == boost::two_bit_black;
  return cut;
}

}  // namespace soapfilm
