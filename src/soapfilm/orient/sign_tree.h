// Signs of normals, spread from neighbor to neighbor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/orient/signed_sets.h"
#include "soapfilm/orient/sites.h"

namespace soapfilm {

/// Some of the sites, numbered in their order. No lists are kept where they are all of them.
class Targets {
 public:
  static constexpr uint32_t none = ~uint32_t{0};

  Targets() = default;
  /// `chosen`: of each site.
  explicit Targets(std::span<const uint8_t> chosen);

  size_t size() const { return size_; }
  bool are_all() const { return slots_.empty(); }
  uint32_t site(size_t slot) const { return are_all() ? static_cast<uint32_t>(slot) : sites_[slot]; }
  /// A site's number among them, or none.
  uint32_t slot(uint32_t site) const { return are_all() ? site : slots_[site]; }

 private:
  size_t size_ = 0;
  std::vector<uint32_t> sites_, slots_;
};

/// Planes of targets and their neighbors. Signs spread between those that take part.
struct SignGraph {
  const Sites& sites;
  const Targets& targets;
  std::span<const uint32_t> near;  ///< of each target so many sites, the nearest, nearest first
  size_t neighbors;                ///< < 2^16
  std::span<const Plane> planes;
  std::span<const uint8_t> takes_part;

  std::span<const uint32_t> near_to(size_t slot) const { return near.subspan(slot * neighbors, neighbors); }
};

/// The connected parts, each with the signs along its minimum spanning tree: edges are pairs of neighbors, those with
/// the most nearly parallel normals first (the weight 1 - |n_a . n_b| of Hoppe et al., in 65536 steps; equal ones in
/// the order Sites::before), and those above each other last: the way from one side of a thin body to the other is
/// around its rim.
///
/// Kruskal's algorithm, first on each block of targets alone: an edge that closes a cycle there is in no minimum
/// spanning tree, and one that is the lightest way out of a part that no other block touches is in it. The edges left
/// are few, some of those at the ends of blocks. `block`, 1 to 2^16: targets; the result does not depend on it.
SignedSets spread_signs(const SignGraph& graph, const Context& context, size_t block = size_t{1} << 15);

}  // namespace soapfilm
