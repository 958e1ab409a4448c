// Sets that are joined in pairs (union-find). The result does not depend on the order of the joins.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace soapfilm {

class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  size_t size() const { return parent_.size(); }
  /// The smallest member of i's set.
  uint32_t root(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Joins two sets; returns whether they were different.
  bool join(uint32_t a, uint32_t b) {
    const uint32_t ra = root(a), rb = root(b);
    parent_[std::max(ra, rb)] = std::min(ra, rb);
    return ra != rb;
  }

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace soapfilm
