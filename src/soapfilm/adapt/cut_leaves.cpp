#include "soapfilm/adapt/cut_leaves.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <utility>

#include "soapfilm/adapt/leaf_links.h"
#include "soapfilm/adapt/leaf_parts.h"
#include "soapfilm/adapt/levels_of_sides.h"
#include "soapfilm/core/indices.h"

namespace soapfilm {

namespace {

/// Some of the leaves as the vertices of a graph, in their order.
class LeafGraph {
 public:
  LeafGraph(const LeafLinks& links, const LeafSet& in, std::span<const SupportField> data)
      : links_(links), in_(in), data_(data), before_(in.bits.size()) {
    uint64_t count = 0;
    for (size_t b = 0; b < before_.size(); ++b)
      for (size_t z = 0; z < brick_side; ++z) {
        before_[b][z] = static_cast<uint32_t>(count);
        count += static_cast<uint64_t>(count_bits(in.bits[b].layer[z]));
      }
    require_indices(count, most_indices - 2, "leaves of a graph cut");  // and two terminals
    vertices_ = static_cast<uint32_t>(count);
  }

  uint32_t vertices() const { return vertices_; }

  /// Links to leaves outside the graph are left out; several to one leaf are one.
  void stream(const std::function<void(const NetworkVertex&)>& visit) const {
    NetworkVertex vertex;
    uint32_t number = 0;
    for_each([&](const Leaf& leaf, double f) {
      vertex.unary = -f;
      vertex.links.clear();
      links_.for_each_link(leaf, [&](const Leaf* other, double weight) {
        if (!other)
          vertex.unary += weight;
        else if (in_.test(*other))
          if (const uint32_t end = number_of(*other); end > number) add(vertex, end, weight);
      });
      visit(vertex);
      ++number;
    });
  }

  /// sum of unary u + sum over links of weight |u_i - u_j|.
  double energy(const std::vector<bool>& inside) const {
    double sum = 0;
    size_t number = 0;
    stream([&](const NetworkVertex& vertex) {
      const bool own = inside[number++];
      if (own) sum += vertex.unary;
      for (const auto& link : vertex.links)
        if (inside[link.first] != own) sum += link.second;
    });
    return sum;
  }

  LeafSet leaves_of(const std::vector<bool>& inside) const {
    LeafSet set = links_.none();
    size_t number = 0;
    in_.for_each([&](const Leaf& leaf) {
      if (inside[number++]) set.set(leaf);
    });
    return set;
  }

 private:
  static void add(NetworkVertex& vertex, uint32_t end, double weight) {
    for (auto& link : vertex.links)
      if (link.first == end) {
        link.second += weight;
        return;
      }
    vertex.links.emplace_back(end, weight);
  }

  template <class Visit>
  void for_each(Visit&& visit) const {
    for (size_t b = 0; b < in_.bits.size(); ++b) {
      if (!in_.bits[b].any()) continue;
      const SupportField& field = data_[static_cast<size_t>(links_.level(b))];
      const int32_t n = field.grid.find(links_.coord(b));
      const float* f = n < 0 ? nullptr : field.f.brick(static_cast<size_t>(n));
      in_.bits[b].for_each([&](int i) { visit(Leaf{b, i}, f ? static_cast<double>(f[i]) : 0.0); });
    }
  }

  uint32_t number_of(const Leaf& leaf) const {
    const auto z = static_cast<size_t>(leaf.offset) / brick_area;
    const uint64_t below = (uint64_t{1} << leaf.offset % brick_area) - 1;
    return before_[leaf.brick][z] + static_cast<uint32_t>(count_bits(in_.bits[leaf.brick].layer[z] & below));
  }

  const LeafLinks& links_;
  const LeafSet& in_;
  std::span<const SupportField> data_;
  std::vector<std::array<uint32_t, brick_side>> before_;  ///< leaves before each layer of each brick
  uint32_t vertices_ = 0;
};

/// The leaves with data, and those linked to them.
LeafSet around_data(const LeafLinks& links, std::span<const SupportField> data) {
  LeafSet near = links.none();
  for (size_t l = 0; l < data.size(); ++l)
    for (size_t k = 0; k < data[l].grid.size(); ++k) {
      const size_t b = links.find(static_cast<int>(l), data[l].grid.coord(k));
      if (b == links.bricks()) continue;
      const float* f = data[l].f.brick(k);
      links.free(b).for_each([&](int i) {
        if (f[i] == 0) return;
        near.set({b, i});
        links.for_each_link({b, i}, [&](const Leaf* other, double) {
          if (other) near.set(*other);
        });
      });
    }
  return near;
}

struct LeafFlood {
  LeafSet reached;
  bool all = false;  ///< whatever can be reached is
};

/// The leaves outside the graph that at most `reach` links connect to `sources` without crossing it; with those of the
/// sources that are outside.
LeafFlood flooded(const LeafLinks& links, const LeafSet& graph, const LeafSet& sources, int reach) {
  LeafFlood flood{links.none(), false};
  std::vector<Leaf> front, next;
  sources.for_each([&](const Leaf& leaf) {
    front.push_back(leaf);
    if (!graph.test(leaf)) flood.reached.set(leaf);
  });
  for (int step = 0; step < reach && !front.empty(); ++step) {
    next.clear();
    for (const Leaf& leaf : front)
      links.for_each_link(leaf, [&](const Leaf* other, double) {
        if (!other || graph.test(*other) || flood.reached.test(*other)) return;
        flood.reached.set(*other);
        next.push_back(*other);
      });
    front.swap(next);
  }
  flood.all = front.empty();
  return flood;
}

/// Adds to the graph the leaves near both labels of a boundary that disagrees: the minimal surface passes there.
/// Increases `reach` until new leaves are found. Returns false where there are none.
bool grow(const LeafLinks& links, const LeafVotes& votes, LeafSet& graph, int& reach, const Context& context) {
  for (;; reach = twice_the_reach(reach)) {
    context.check();
    const LeafFlood inside = flooded(links, graph, votes.inside, reach);
    LeafFlood outside = flooded(links, graph, votes.outside, reach);
    LeafSet between = std::move(outside.reached);
    for (size_t b = 0; b < links.bricks(); ++b) between.bits[b] &= inside.reached.bits[b];
    if (!between.any()) {
      if (inside.all && outside.all) return false;
      continue;
    }
    for (size_t b = 0; b < links.bricks(); ++b) graph.bits[b] |= between.bits[b];
    return true;
  }
}

/// Memory beside a graph.
uint64_t bytes_beside(const LeafLinks& links, const LeafSet& graph) {
  const auto mixed = static_cast<uint64_t>(
      std::count_if(graph.bits.begin(), graph.bits.end(), [](const BrickBits& bits) { return bits.any(); }));
  return links.bytes() + leaf_brick_bytes * links.bricks() + mixed_brick_bytes * mixed;
}

/// The sides of all leaves; none if a graph does not fit.
std::optional<LeafSet> sides_of_leaves(const LeafLinks& links, std::span<const SupportField> data,
                                       const LeafCutSetup& how, const Context& context, GraphCutReport& report) {
  constexpr int first_reach = 32;  // four times the links of solve_graph_cut(): the same surface after fewer cuts
  LeafSet in_graph = around_data(links, data);
  for (int reach = first_reach;; reach = twice_the_reach(reach)) {
    context.check();
    if (how.fits && !how.fits(in_graph.count(), bytes_beside(links, in_graph))) return {};
    const LeafGraph graph(links, in_graph, data);
    context.progress().detail(fmt::format("graph cut {}: {} leaves", report.growths + 1, graph.vertices()));
    const MinCut cut = min_cut(
        graph.vertices(), [&](const auto& visit) { graph.stream(visit); }, context);
    LeafSet inside = graph.leaves_of(cut.inside);
    LeafParts parts(links, in_graph);
    const LeafVotes votes = parts.vote(inside);
    report.globally_optimal = votes.agree;
    report.graph_bytes = std::max(report.graph_bytes, cut.bytes);
    LeafSet grown = in_graph;
    if (votes.agree || !grow(links, votes, grown, reach, context)) {
      report.vertices = graph.vertices();
      report.links = cut.links;
      report.flow = cut.flow;
      report.energy = graph.energy(cut.inside);
      parts.fill(inside);
      return inside;
    }
    in_graph = std::move(grown);
    ++report.growths;
  }
}

}  // namespace

std::optional<std::vector<Level>> cut_leaves(const Regions& regions, const Lattice& lattice,
                                             std::span<const SupportField> data, const LeafCutSetup& how,
                                             const Context& context, GraphCutReport& report) {
  const auto start = std::chrono::steady_clock::now();
  report = {};
  const LeafLinks links(regions, lattice, how.graph, how.lambda, context);
  const std::optional<LeafSet> inside = sides_of_leaves(links, data, how, context, report);
  if (!inside) return {};
  std::vector<Level> levels = levels_of_sides(links, *inside, data, how.graph.norm, context);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return levels;
}

}  // namespace soapfilm
