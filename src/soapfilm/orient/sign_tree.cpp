#include "soapfilm/orient/sign_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr size_t weight_steps = 1 << 16;

/// From a target to the `rank`-th of its neighbors. Both may be neighbors of each other: then from the first of them.
struct Edge {
  uint64_t lot;  ///< of a
  uint32_t a, b;
  uint16_t weight, rank;
  int8_t sign;  ///< of b relative to a
};

/// The same within a block, numbers relative to its begin.
struct InnerEdge {
  uint16_t a, b, weight, rank;
};

class SignTree {
 public:
  SignTree(const SignGraph& graph, size_t block, const Context& context)
      : graph_(graph), block_(block), context_(context), sets_(graph.targets.size()) {
    std::vector<Edge> open = crossing_edges();
    touched_.assign(graph.targets.size(), 0);
    for (const Edge& e : open) touched_[e.a] = touched_[e.b] = 1;
    std::vector<std::vector<Edge>> undecided((graph.targets.size() + block - 1) / block);
    parallel_chunks(context, graph.targets.size(), block, [&](size_t begin, size_t end) {
      context.check();
      undecided[begin / block] = join_within(begin, end);
    });
    for (const std::vector<Edge>& part : undecided) open.insert(open.end(), part.begin(), part.end());
    std::sort(open.begin(), open.end(), [&](const Edge& e, const Edge& f) { return comes_first(e, f); });
    for (const Edge& e : open) sets_.join(e.a, e.b, e.sign);
  }

  SignedSets take() { return std::move(sets_); }

 private:
  bool comes_first(const Edge& e, const Edge& f) const {
    if (e.a == f.a || e.weight != f.weight || e.lot != f.lot)
      return std::tie(e.weight, e.lot, e.rank) < std::tie(f.weight, f.lot, f.rank);
    return graph_.sites.before(graph_.targets.site(e.a), graph_.targets.site(f.a));
  }

  bool is_near(uint32_t a, uint32_t b) const {
    const auto of_b = graph_.near_to(b);
    return std::find(of_b.begin(), of_b.end(), graph_.targets.site(a)) != of_b.end();
  }

  /// Or above each other, as the two sides of a thin body?
  bool lie_beside_each_other(uint32_t a, uint32_t b) const {
    constexpr double steep = 0.7;  // cosine
    const Vec3d step = graph_.sites[graph_.targets.site(b)] - graph_.sites[graph_.targets.site(a)];
    const double height =
        std::max(std::abs(dot(step, graph_.planes[a].normal)), std::abs(dot(step, graph_.planes[b].normal)));
    return height <= steep * norm(step);
  }

  uint16_t weight(uint32_t a, uint32_t b) const {
    const double w =
        lie_beside_each_other(a, b) ? 1.0 - std::abs(dot(graph_.planes[a].normal, graph_.planes[b].normal)) : 1.0;
    return static_cast<uint16_t>(std::clamp(w, 0.0, 1.0) * (weight_steps - 1));
  }

  int8_t sign(uint32_t a, uint32_t b) const {
    return dot(graph_.planes[a].normal, graph_.planes[b].normal) < 0.0 ? -1 : 1;
  }

  /// A neighbor of a that takes part, too; or none.
  uint32_t partner(uint32_t a, size_t rank) const {
    const uint32_t b = graph_.targets.slot(graph_.near_to(a)[rank]);
    return b == Targets::none || !graph_.takes_part[b] ? Targets::none : b;
  }

  std::vector<Edge> crossing_edges() const {
    return gather<Edge>(graph_.targets.size(), block_, context_, [&](size_t slot, std::vector<Edge>& found) {
      const auto a = static_cast<uint32_t>(slot);
      if (!graph_.takes_part[a]) return;
      for (size_t rank = 0; rank < graph_.neighbors; ++rank) {
        const uint32_t b = partner(a, rank);
        if (b == Targets::none || a / block_ == b / block_) continue;
        const uint32_t site = graph_.targets.site(a);
        if (is_near(a, b) && graph_.sites.before(graph_.targets.site(b), site)) continue;  // it is found from b
        found.push_back({graph_.sites.lot(site), a, b, weight(a, b), static_cast<uint16_t>(rank), sign(a, b)});
      }
    });
  }

  struct Lots {
    std::vector<uint64_t> lot;
    std::vector<uint32_t> order, place;  ///< by Sites::before, and its inverse
  };
  Lots draw_lots(size_t begin, size_t end) const {
    Lots lots;
    for (size_t slot = begin; slot < end; ++slot) lots.lot.push_back(graph_.sites.lot(graph_.targets.site(slot)));
    lots.order.resize(end - begin);
    std::iota(lots.order.begin(), lots.order.end(), 0u);
    std::sort(lots.order.begin(), lots.order.end(), [&](uint32_t a, uint32_t b) {
      if (lots.lot[a] != lots.lot[b]) return lots.lot[a] < lots.lot[b];
      return graph_.sites.before(graph_.targets.site(begin + a), graph_.targets.site(begin + b));
    });
    lots.place.resize(end - begin);
    for (uint32_t k = 0; k < lots.order.size(); ++k) lots.place[lots.order[k]] = k;
    return lots;
  }

  std::vector<InnerEdge> sorted_edges(size_t begin, size_t end, const Lots& lots) const {
    std::vector<InnerEdge> edges;
    edges.reserve((end - begin) * graph_.neighbors * 3 / 4);  // of the neighbors a half to all are so of each other
    for (const uint32_t inner : lots.order) {
      const auto a = static_cast<uint32_t>(begin + inner);
      if (!graph_.takes_part[a]) continue;
      for (size_t rank = 0; rank < graph_.neighbors; ++rank) {
        const uint32_t b = partner(a, rank);
        if (b == Targets::none || b < begin || b >= end) continue;
        if (lots.place[b - begin] < lots.place[inner] && is_near(a, b)) continue;  // it was found from b
        edges.push_back({static_cast<uint16_t>(inner), static_cast<uint16_t>(b - begin), weight(a, b),
                         static_cast<uint16_t>(rank)});
      }
    }
    std::vector<uint32_t> next(weight_steps + 1, 0);  // counting sort: stable
    for (const InnerEdge& e : edges) ++next[e.weight + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<InnerEdge> sorted(edges.size());
    for (const InnerEdge& e : edges) sorted[next[e.weight]++] = e;
    return sorted;
  }

  /// Joins what is certainly joined by edges of the block [begin, end), and returns those of which others decide.
  std::vector<Edge> join_within(size_t begin, size_t end) {
    const Lots lots = draw_lots(begin, end);
    std::vector<uint8_t> touched(touched_.begin() + static_cast<std::ptrdiff_t>(begin),
                                 touched_.begin() + static_cast<std::ptrdiff_t>(end));  // parts, at their roots
    DisjointSets connected(end - begin);
    std::vector<Edge> undecided;
    for (const InnerEdge& e : sorted_edges(begin, end, lots)) {
      if (!connected.join(e.a, e.b)) continue;
      const auto a = static_cast<uint32_t>(begin + e.a), b = static_cast<uint32_t>(begin + e.b);
      const size_t part_of_a = sets_.find(a).index - begin, part_of_b = sets_.find(b).index - begin;
      if (touched[part_of_a] && touched[part_of_b]) {
        undecided.push_back({lots.lot[e.a], a, b, e.weight, e.rank, sign(a, b)});
        continue;
      }
      sets_.join(a, b, sign(a, b));
      touched[std::min(part_of_a, part_of_b)] = touched[part_of_a] || touched[part_of_b];
    }
    return undecided;
  }

  const SignGraph& graph_;
  size_t block_;
  const Context& context_;
  SignedSets sets_;
  std::vector<uint8_t> touched_;  ///< of each target: an edge leads to another block
};

}  // namespace

Targets::Targets(std::span<const uint8_t> chosen)
    : size_(static_cast<size_t>(std::count(chosen.begin(), chosen.end(), 1))) {
  if (size_ == chosen.size()) return;
  sites_.reserve(size_);
  slots_.assign(chosen.size(), none);
  for (uint32_t site = 0; site < chosen.size(); ++site) {
    if (!chosen[site]) continue;
    slots_[site] = static_cast<uint32_t>(sites_.size());
    sites_.push_back(site);
  }
}

SignedSets spread_signs(const SignGraph& graph, const Context& context, size_t block) {
  return SignTree(graph, block, context).take();
}

}  // namespace soapfilm
