// The connected parts of the leaves outside a graph of some of them: as solve/outside_parts.h for one level.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/adapt/leaf_links.h"

namespace soapfilm {

/// What the labels of a graph's leaves say of the parts that they are linked to. A part linked to fixed vertices must
/// have u = 0.
struct LeafVotes {
  LeafSet inside;  ///< leaves of the graph with u = 1 linked to a part whose boundary disagrees
  /// The same with u = 0. Of a part that has u = 0 from fixed vertices alone: its leaves beside these.
  LeafSet outside;
  bool agree = true;
};

/// The leaves outside the graph; those joined by a link are one part.
class LeafParts {
 public:
  /// Both must outlive the parts.
  LeafParts(const LeafLinks& links, const LeafSet& graph);

  LeafVotes vote(const LeafSet& inside);
  /// Sets the leaves of the parts that the last vote gives u = 1: all of whose boundary has it.
  void fill(LeafSet& inside);

 private:
  /// What a part is linked to, as bits.
  enum Seen : uint8_t { inside_leaf = 1, outside_leaf = 2, fixed_vertex = 4 };
  static bool agrees(uint8_t seen) { return !(seen & inside_leaf) || seen == inside_leaf; }

  /// Of a brick without leaves of the graph all leaves are one element, else each is one.
  size_t element(const Leaf& leaf) const {
    return first_[leaf.brick] + (mixed(leaf.brick) ? static_cast<size_t>(leaf.offset) : 0);
  }
  bool mixed(size_t brick) const { return first_[brick + 1] - first_[brick] > 1; }
  size_t root(size_t element);
  void join(size_t a, size_t b);
  void join_around(size_t brick);
  /// Calls visit(leaf, part) for the leaves outside the graph that have a link to a fixed vertex.
  template <class Visit>
  void for_each_beside_fixed(Visit&& visit);
  /// Calls visit(leaf of the graph, part) for every link between the graph and a leaf outside it.
  template <class Visit>
  void for_each_rim_link(Visit&& visit);

  const LeafLinks& links_;
  const LeafSet& graph_;
  std::vector<size_t> first_;     ///< element of each brick; one more at the end
  std::vector<uint32_t> parent_;  ///< of each element
  std::vector<uint8_t> seen_;     ///< per element, used at roots
};

}  // namespace soapfilm
