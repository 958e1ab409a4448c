#include "soapfilm/adapt/leaf_parts.h"

#include <algorithm>
#include <numeric>

#include "soapfilm/core/indices.h"
#include "soapfilm/solve/domain.h"

namespace soapfilm {

LeafParts::LeafParts(const LeafLinks& links, const LeafSet& graph)
    : links_(links), graph_(graph), first_(links.bricks() + 1) {
  for (size_t b = 0; b < links.bricks(); ++b)
    first_[b + 1] = first_[b] + (graph.bits[b].any() ? size_t{brick_volume} : 1);
  require_indices(first_.back(), most_indices, "leaves around the graph of a cut");
  parent_.resize(first_.back());
  std::iota(parent_.begin(), parent_.end(), 0u);
  for (size_t b = 0; b < links.bricks(); ++b) join_around(b);
}

size_t LeafParts::root(size_t element) {
  while (parent_[element] != element) element = parent_[element] = parent_[parent_[element]];
  return element;
}

void LeafParts::join(size_t a, size_t b) {
  const size_t ra = root(a), rb = root(b);
  parent_[std::max(ra, rb)] = static_cast<uint32_t>(std::min(ra, rb));
}

/// Joins what a brick has outside the graph, and what lies beside it. The free vertices of a brick are a box, so those
/// of bricks that touch are linked.
void LeafParts::join_around(size_t brick) {
  if (!mixed(brick)) {
    links_.for_each_beside(brick, [&](size_t beside) {
      if (!mixed(beside)) join(first_[brick], first_[beside]);
    });
    return;
  }
  (links_.free(brick) & ~graph_.bits[brick]).for_each([&](int i) {
    const Leaf leaf{brick, i};
    links_.for_each_link(leaf, [&](const Leaf* other, double) {
      // Between mixed bricks each pair once.
      if (!other || graph_.test(*other) || (mixed(other->brick) && *other < leaf)) return;
      join(element(leaf), element(*other));
    });
  });
}

template <class Visit>
void LeafParts::for_each_beside_fixed(Visit&& visit) {
  for (size_t b = 0; b < links_.bricks(); ++b) {
    if (!at_border(links_.box(links_.level(b)), links_.coord(b))) continue;
    (links_.free(b) & ~graph_.bits[b]).for_each([&](int i) {
      const Leaf leaf{b, i};
      bool fixed = false;
      links_.for_each_link(leaf, [&](const Leaf* other, double) { fixed = fixed || !other; });
      if (fixed) visit(leaf, root(element(leaf)));
    });
  }
}

template <class Visit>
void LeafParts::for_each_rim_link(Visit&& visit) {
  graph_.for_each([&](const Leaf& leaf) {
    links_.for_each_link(leaf, [&](const Leaf* other, double) {
      if (other && !graph_.test(*other)) visit(leaf, root(element(*other)));
    });
  });
}

LeafVotes LeafParts::vote(const LeafSet& inside) {
  seen_.assign(parent_.size(), 0);
  for_each_beside_fixed([&](const Leaf&, size_t part) { seen_[part] |= fixed_vertex; });
  for_each_rim_link(
      [&](const Leaf& leaf, size_t part) { seen_[part] |= inside.test(leaf) ? inside_leaf : outside_leaf; });
  LeafVotes votes{links_.none(), links_.none(), true};
  for_each_rim_link([&](const Leaf& leaf, size_t part) {
    if (agrees(seen_[part])) return;
    votes.agree = false;
    (inside.test(leaf) ? votes.inside : votes.outside).set(leaf);
  });
  if (votes.agree) return votes;
  for_each_beside_fixed([&](const Leaf& leaf, size_t part) {
    if (!agrees(seen_[part]) && !(seen_[part] & outside_leaf)) votes.outside.set(leaf);
  });
  return votes;
}

void LeafParts::fill(LeafSet& inside) {
  for (size_t b = 0; b < links_.bricks(); ++b)
    (links_.free(b) & ~graph_.bits[b]).for_each([&](int i) {
      if (seen_[root(element({b, i}))] == inside_leaf) inside.set({b, i});
    });
}

}  // namespace soapfilm
