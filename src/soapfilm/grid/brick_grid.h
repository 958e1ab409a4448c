// The topology of one level: which bricks are active, their order, and their neighbors.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/grid/layout.h"

namespace soapfilm {

/// A sparse set of bricks in lexicographic order (x fastest, then y, then z), so that of two neighbors along an axis
/// the lower one always comes first: the fused sweeps rely on it. Immutable.
class BrickGrid {
 public:
  using Neighbors = std::array<int32_t, 27>;

  BrickGrid() = default;
  /// The set bricks of `active`. At most 2^31 - 1 bricks.
  BrickGrid(const BrickMask& active, const Context& context);

  size_t size() const { return coords_.size(); }
  size_t vertices() const { return size() * brick_volume; }
  /// Size of the box of bricks around the active ones.
  Vec3i bricks() const { return bricks_; }

  Vec3i coord(size_t brick) const { return coords_[brick]; }
  /// Lattice coordinates of a brick's first vertex.
  Vec3i first_vertex(size_t brick) const { return coords_[brick] * brick_side; }

  /// Index of the active brick at `b`; `outside_band` or `outside_box` if there is none.
  int32_t find(Vec3i b) const {
    if (!in_box(b)) return outside_box;
    const size_t i = BrickMask::index(bricks_, b);
    const Word& word = words_[i >> 6];
    return word.bits >> (i & 63) & 1 ? rank(i) : outside_band;
  }
  /// Indices [begin, end) of the active bricks (x, y, z) of a row along x; y and z in the box.
  std::pair<size_t, size_t> row(int y, int z) const {
    const size_t first = BrickMask::index(bricks_, {0, y, z});
    return {static_cast<size_t>(rank(first)), static_cast<size_t>(rank(first + static_cast<size_t>(bricks_.x)))};
  }
  /// The same for all rows with this z.
  std::pair<size_t, size_t> layer(int z) const { return {row(0, z).first, row(bricks_.y - 1, z).second}; }
  /// Number, from 0 in lexicographic order, of the run along x of missing bricks that holds the missing brick `b` of
  /// the box. A row with k active bricks has k + 1 runs, before, between and after them; some are empty.
  int32_t gap(Vec3i b) const;
  /// Indices of the 27 bricks around a brick by neighbor_slot(), with the same two values for missing ones.
  const Neighbors& neighbors(size_t brick) const { return neighbors_[brick]; }

  size_t bytes() const { return size() * (sizeof(Vec3i) + sizeof(Neighbors)) + words_.size() * sizeof(Word); }

 private:
  /// 64 bricks of the box, active or not, and the number of active bricks before them: so any brick is found in
  /// constant time (Jacobson 1989, "Space-efficient static trees and graphs": rank).
  struct Word {
    uint64_t bits;
    int32_t before;
  };
  /// Number of active bricks before brick `i` of the box, or before its end.
  int32_t rank(size_t i) const {
    const Word& word = words_[i >> 6];
    return word.before + count_bits(word.bits & ((uint64_t{1} << (i & 63)) - 1));
  }

  bool in_box(Vec3i b) const {
    return b.x >= 0 && b.y >= 0 && b.z >= 0 && b.x < bricks_.x && b.y < bricks_.y && b.z < bricks_.z;
  }

  Vec3i bricks_;
  std::vector<Vec3i> coords_;
  std::vector<Word> words_;  ///< and one for the end
  std::vector<Neighbors> neighbors_;
};

/// The bricks of the next coarser level, in a box of `bricks`, that have any of their 8 children in a grid.
BrickMask parents_of(const BrickGrid& children, Vec3i bricks, const Context& context);

}  // namespace soapfilm
