// Disjoint sets whose members know their sign relative to the set's representative.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace soapfilm {

class SignedSets {
 public:
  explicit SignedSets(size_t count) : parent_(count), sign_(count, 1) { std::iota(parent_.begin(), parent_.end(), 0u); }

  struct Root {
    uint32_t index;
    int sign;
  };
  Root find(uint32_t i) {
    uint32_t root = i;
    int sign = 1;
    while (parent_[root] != root) {
      sign *= sign_[root];
      root = parent_[root];
    }
    // Path compression: every member on the way stores the root and its sign relative to it.
    for (int rest = sign; parent_[i] != root && i != root;) {
      const uint32_t next = parent_[i];
      const int own = sign_[i];
      parent_[i] = root;
      sign_[i] = static_cast<int8_t>(rest);
      rest *= own;
      i = next;
    }
    return {root, sign};
  }
  /// Joins the sets of a and b so that b's sign is `relative` times a's; no change if they are one set already.
  void join(uint32_t a, uint32_t b, int relative) {
    const Root ra = find(a), rb = find(b);
    if (ra.index == rb.index) return;
    const auto [low, high] = std::minmax(ra.index, rb.index);
    parent_[high] = low;
    sign_[high] = static_cast<int8_t>(ra.sign * rb.sign * relative);
  }

 private:
  std::vector<uint32_t> parent_;
  std::vector<int8_t> sign_;
};

}  // namespace soapfilm
