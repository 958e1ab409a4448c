// Boost.Graph's max-flow on its compressed sparse row graph, with as little memory per link as possible: 4 bytes for
// the edge's end and 8 for its residual capacity. Reverse edges are computed: the edges of a vertex are in the order of
// directions, so the reverse of its k-th edge is found by counting bits in the two vertices' sets of directions.
#include "soapfilm/solve/min_cut.h"

#include <bit>
#include <iterator>
#include <utility>

#include "soapfilm/core/bits.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/solve/max_flow.h"

namespace soapfilm {

namespace {

/// Bits in a vertex's set of directions, after those of its links: it has an edge to the source, to the sink.
constexpr int bit_of_source = max_links;
constexpr uint32_t to_source = 1u << bit_of_source;
constexpr uint32_t to_sink = to_source << 1;

/// The vertices' data before there are edges.
struct Nodes {
  std::vector<uint32_t> directions;  ///< the links as in BandVertex, and to_source or to_sink
  std::vector<double> unary;
  size_t links = 0;      ///< both ways
  size_t terminals = 0;  ///< vertices with an edge to a terminal

  explicit Nodes(const BandGraph& graph) : directions(graph.vertices()), unary(graph.vertices()) {
    BandGraph::Cursor cursor(graph);
    for (BandVertex v; cursor.next(v);) {
      directions[v.id] = v.links | (v.unary < 0 ? to_source : v.unary > 0 ? to_sink : 0u);
      unary[v.id] = v.unary;
      links += static_cast<size_t>(count_bits(v.links));
      terminals += v.unary < 0 || v.unary > 0;  // as above: not-a-number has no edge
    }
  }
};

/// The edges in the order of their sources, generated when the graph's constructor reads them: those of the vertices,
/// then those of the source and of the sink.
class EdgeStream {
 public:
  EdgeStream(const BandGraph& graph, const Nodes& nodes) : nodes_(nodes), cursor_(graph), source_(graph.vertices()) {}

  std::pair<uint32_t, uint32_t> next() {
    while (rest_ == 0 && from_ < source_) {
      from_ = cursor_.next(vertex_) ? vertex_.id : source_;
      rest_ = from_ < source_ ? nodes_.directions[from_] : 0;
    }
    if (from_ >= source_) return next_of_terminal();
    const int direction = std::countr_zero(rest_);
    rest_ &= rest_ - 1;
    return {from_, direction < bit_of_source ? vertex_.neighbor[static_cast<size_t>(direction)]
                                             : source_ + static_cast<uint32_t>(direction - bit_of_source)};
  }

 private:
  std::pair<uint32_t, uint32_t> next_of_terminal() {
    for (;; ++to_) {
      if (to_ == source_) {
        ++from_;
        to_ = 0;
      }
      if (nodes_.directions[to_] & (from_ == source_ ? to_source : to_sink)) return {from_, to_++};
    }
  }

  const Nodes& nodes_;
  BandGraph::Cursor cursor_;
  BandVertex vertex_;
  uint32_t source_;    ///< the sink is source_ + 1
  uint32_t from_ = 0;  ///< vertex or terminal whose edges are being generated
  uint32_t rest_ = 0;  ///< its remaining directions
  uint32_t to_ = 0;    ///< next candidate of a terminal's edges
};

/// The stream as a pair of input iterators.
class EdgeIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = std::pair<uint32_t, uint32_t>;
  using difference_type = std::ptrdiff_t;
  using pointer = const value_type*;
  using reference = const value_type&;

  EdgeIterator(EdgeStream& stream, size_t left) : stream_(stream), left_(left) { read(); }
  const value_type& operator*() const { return edge_; }
  const value_type* operator->() const { return &edge_; }
  EdgeIterator& operator++() {
    --left_;
    read();
    return *this;
  }
  bool operator!=(const EdgeIterator& other) const { return left_ != other.left_; }

 private:
  void read() {
    if (left_ > 0) edge_ = stream_.next();
  }

  EdgeStream& stream_;
  size_t left_;
  value_type edge_;
};

FlowGraph make_graph(const BandGraph& band, const Nodes& nodes) {
  EdgeStream stream(band, nodes);
  const size_t edges = nodes.links + 2 * nodes.terminals;
  return FlowGraph(boost::edges_are_sorted, EdgeIterator(stream, edges), EdgeIterator(stream, 0), band.vertices() + 2,
                   static_cast<uint32_t>(edges));
}

/// The direction of a vertex's k-th edge.
int nth_direction(uint32_t directions, uint32_t k) {
  const uint32_t up_to_k = (2u << k) - 1;
  if ((directions & up_to_k) == up_to_k) return static_cast<int>(k);
  for (; k > 0; --k) directions &= directions - 1;
  return std::countr_zero(directions);
}

/// Finds the reverse of an edge.
struct Reverse {
  const FlowGraph* graph;
  const uint32_t* directions;     ///< per vertex
  const uint32_t* terminal_edge;  ///< per vertex: number of the edge from its terminal
  uint32_t vertices;
  int last_direction;  ///< the opposite of d is last_direction - d

  uint32_t first_edge(uint32_t vertex) const { return graph->m_forward.m_rowstart[vertex]; }
  FlowEdge operator()(FlowEdge edge) const {
    const uint32_t to = graph->m_forward.m_column[edge.idx];
    if (edge.src >= vertices) return {to, first_edge(to + 1) - 1};
    const int direction = nth_direction(directions[edge.src], edge.idx - first_edge(edge.src));
    if (direction > last_direction) return {to, terminal_edge[edge.src]};
    const uint32_t before = directions[to] & ((1u << (last_direction - direction)) - 1);
    return {to, first_edge(to) + static_cast<uint32_t>(count_bits(before))};
  }
};

// Property maps, by Boost's concepts.
struct ReverseMap {
  using key_type = FlowEdge;
  using value_type = FlowEdge;
  using reference = FlowEdge;
  using category = boost::readable_property_map_tag;
  Reverse reverse;
};
FlowEdge get(const ReverseMap& map, FlowEdge edge) { return map.reverse(edge); }

/// A vertex's edge from its parent in the source's tree, or to it in the sink's tree, in one byte: the number of its
/// edge to the parent, and the tree.
struct ParentMap {
  using key_type = uint32_t;
  using value_type = FlowEdge;
  using reference = FlowEdge;
  using category = boost::read_write_property_map_tag;
  static constexpr uint8_t sinks_tree = 0x80;
  uint8_t* codes;
  Reverse reverse;
  FlowCheck* check;
};
FlowEdge get(const ParentMap& map, uint32_t vertex) {
  const uint8_t code = map.codes[vertex];
  const FlowEdge own{vertex, map.reverse.first_edge(vertex) + (code & ~ParentMap::sinks_tree & 0xFFu)};
  return code & ParentMap::sinks_tree ? own : map.reverse(own);
}
void put(const ParentMap& map, uint32_t vertex, FlowEdge edge) {
  map.check->count();
  const bool sinks = edge.src == vertex;
  const FlowEdge own = sinks ? edge : map.reverse(edge);
  map.codes[vertex] =
      static_cast<uint8_t>((own.idx - map.reverse.first_edge(vertex)) | (sinks ? ParentMap::sinks_tree : 0u));
}

/// Number of the edge that leads from its terminal to each vertex.
std::vector<uint32_t> terminal_edges(const FlowGraph& graph, uint32_t vertices) {
  std::vector<uint32_t> edge(vertices);
  for (uint32_t e = graph.m_forward.m_rowstart[vertices]; e < graph.m_forward.m_column.size(); ++e)
    edge[graph.m_forward.m_column[e]] = e;
  return edge;
}

/// Both directions of a link have its weight; the edges from the source and to the sink have the vertex's unary term.
std::vector<double> capacities(const FlowGraph& graph, const Nodes& nodes, const std::vector<Link>& links,
                               const std::vector<uint32_t>& terminal_edge) {
  std::vector<double> capacity(graph.m_forward.m_column.size(), 0.0);
  size_t e = 0;
  for (size_t v = 0; v < nodes.directions.size(); ++v)
    for (uint32_t rest = nodes.directions[v]; rest != 0; rest &= rest - 1, ++e) {
      const uint32_t lowest = rest & -rest;
      if (lowest == to_source)
        capacity[terminal_edge[v]] = -nodes.unary[v];
      else
        capacity[e] = lowest == to_sink ? nodes.unary[v] : links[static_cast<size_t>(std::countr_zero(lowest))].weight;
    }
  return capacity;
}

/// Boost stores per vertex a time stamp of 8 bytes and two bits, and a queue of 4 bytes per active vertex.
constexpr double own_bytes_per_vertex = sizeof(long) + 2.0 / 8;

}  // namespace

MinCut min_cut(const BandGraph& band, const Context& context) {
  Nodes nodes(band);
  const uint32_t n = band.vertices();
  const FlowGraph graph = make_graph(band, nodes);
  const std::vector<uint32_t> terminal_edge = terminal_edges(graph, n);
  std::vector<double> residual = capacities(graph, nodes, band.links(), terminal_edge);
  release(nodes.unary);

  const Reverse reverse{&graph, nodes.directions.data(), terminal_edge.data(), n,
                        static_cast<int>(band.links().size()) - 1};
  std::vector<uint8_t> parent(n + 2);
  FlowCheck check(context);
  MinCut cut = max_flow(graph, n, residual, ReverseMap{reverse}, ParentMap{parent.data(), reverse, &check});
  cut.links = nodes.links / 2;
  const size_t per_vertex = sizeof(uint32_t) * 4 + sizeof(uint8_t);  // row start, directions, terminal edge, distance
  cut.bytes = residual.size() * (sizeof(double) + sizeof(uint32_t)) + n * per_vertex + n / 4 +
              static_cast<size_t>(own_bytes_per_vertex * n);
  return cut;
}

}  // namespace soapfilm
