// Boost.Graph's max-flow on its compressed sparse row graph, with a table of reverse edges.
#include "soapfilm/solve/network.h"

#include <fmt/core.h>

#include <limits>

#include "soapfilm/error.h"
#include "soapfilm/solve/max_flow.h"

namespace soapfilm {

namespace {

/// The graph with the terminals as its last two vertices, the source first.
struct Network {
  FlowGraph graph;
  std::vector<uint32_t> reverse;  ///< of each edge
  std::vector<double> residual;   ///< capacities; the algorithm makes residual ones of them
  size_t links = 0;

  const std::vector<uint32_t>& rows() const { return graph.m_forward.m_rowstart; }
  const std::vector<uint32_t>& ends() const { return graph.m_forward.m_column; }
  /// An edge by its number: its source is where its reverse leads.
  FlowEdge edge(uint32_t number) const { return {ends()[reverse[number]], number}; }
};

/// Where each vertex' edges begin; the last one is their number.
std::vector<uint32_t> count_edges(uint32_t vertices, const NetworkStream& stream, size_t& links) {
  std::vector<uint32_t> begin(size_t{vertices} + 3);
  uint64_t edges = 0;
  uint32_t from = 0;
  stream([&](const NetworkVertex& v) {
    for (const auto& link : v.links) {
      ++begin[from + 1];
      ++begin[link.first + 1];
    }
    links += v.links.size();
    edges += 2 * v.links.size();
    if (v.unary < 0 || v.unary > 0) {  // not-a-number has no edge
      ++begin[from + 1];
      ++begin[v.unary < 0 ? vertices + 1 : vertices + 2];
      edges += 2;
    }
    ++from;
  });
  constexpr uint64_t most = std::numeric_limits<uint32_t>::max();
  if (edges > most)
    throw ParameterError(
        fmt::format("graph cut: the graph of {} vertices has {} edges, must be <= {}", vertices, edges, most));
  for (size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  return begin;
}

/// A link with the same capacity both ways, or one to a terminal, which has a capacity one way.
Network make_network(uint32_t vertices, const NetworkStream& stream) {
  Network network;
  std::vector<uint32_t> begin = count_edges(vertices, stream, network.links);
  std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
  const uint32_t edges = begin.back();
  std::vector<uint32_t> end(edges);
  network.reverse.resize(edges);
  network.residual.resize(edges);
  const auto add = [&](uint32_t a, uint32_t b, double forth, double back) {
    const uint32_t there = next[a]++, here = next[b]++;
    end[there] = b;
    end[here] = a;
    network.reverse[there] = here;
    network.reverse[here] = there;
    network.residual[there] = forth;
    network.residual[here] = back;
  };
  uint32_t from = 0;
  stream([&](const NetworkVertex& v) {
    for (const auto& link : v.links) add(from, link.first, link.second, link.second);
    if (v.unary < 0) add(vertices, from, -v.unary, 0);
    if (v.unary > 0) add(from, vertices + 1, v.unary, 0);
    ++from;
  });
  network.graph.m_forward.m_rowstart.swap(begin);
  network.graph.m_forward.m_column.swap(end);
  return network;
}

// Property maps, by Boost's concepts.
struct NetworkReverse {
  using key_type = FlowEdge;
  using value_type = FlowEdge;
  using reference = FlowEdge;
  using category = boost::readable_property_map_tag;
  const Network* network;
};
FlowEdge get(const NetworkReverse& map, FlowEdge edge) {
  return {map.network->ends()[edge.idx], map.network->reverse[edge.idx]};
}

/// The number of a vertex' edge from or to its parent in a search tree.
struct NetworkParent {
  using key_type = uint32_t;
  using value_type = FlowEdge;
  using reference = FlowEdge;
  using category = boost::read_write_property_map_tag;
  uint32_t* edges;
  const Network* network;
  FlowCheck* check;
};
FlowEdge get(const NetworkParent& map, uint32_t vertex) { return map.network->edge(map.edges[vertex]); }
void put(const NetworkParent& map, uint32_t vertex, FlowEdge edge) {
  map.check->count();
  map.edges[vertex] = static_cast<uint32_t>(edge.idx);
}

}  // namespace

MinCut min_cut(uint32_t vertices, const NetworkStream& stream, const Context& context) {
  Network network = make_network(vertices, stream);
  const size_t all = size_t{vertices} + 2;
  std::vector<uint32_t> parent(all);
  FlowCheck check(context);
  MinCut cut = max_flow(network.graph, vertices, network.residual, NetworkReverse{&network},
                        NetworkParent{parent.data(), &network, &check});
  cut.links = network.links;
  // Of a vertex: row start, parent, distance; and Boost's time stamp, colors and queue.
  constexpr size_t each = 3 * sizeof(uint32_t) + sizeof(long) + sizeof(uint32_t) + 1;
  cut.bytes = network.residual.size() * (sizeof(double) + 2 * sizeof(uint32_t)) + all * each;
  return cut;
}

}  // namespace soapfilm
