// The topology of one level: which bricks are active, their order, and their neighbors.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/grid/layout.h"

namespace soapfilm {

/// A sparse set of bricks in lexicographic order (x fastest, then y, then z), so that of two neighbors along an axis
/// the lower one always comes first: the fused sweeps rely on it. Memory and time follow the bricks, not the box around
/// them: bricks form rows along x, rows form slices of equal z, and only those that hold bricks exist. Immutable.
class BrickGrid {
 public:
  using Neighbors = std::array<int32_t, 27>;
  /// Bricks [begin, end) along x.
  struct Row {
    int y;
    size_t begin, end;
  };
  /// Rows [first_row, end_row), whose bricks are [begin, end).
  struct Slice {
    int z;
    size_t first_row, end_row;
    size_t begin, end;
  };

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
    if (!BrickRange::whole(bricks_).contains(b)) return outside_box;
    const Word* word = words_.find(word_of(b));
    return word && (word->bits >> bit_in_word(b) & 1) ? word->rank(b) : outside_band;
  }
  /// Slices with active bricks, by ascending z, and their rows, by ascending y.
  const std::vector<Slice>& slices() const { return slices_; }
  const std::vector<Row>& rows() const { return rows_; }
  /// The first slice whose z is at least the given one; slices().size() if there is none.
  size_t slice_from(int z) const {
    return static_cast<size_t>(
        std::partition_point(slices_.begin(), slices_.end(), [&](const Slice& slice) { return slice.z < z; }) -
        slices_.begin());
  }
  /// The first row of a slice whose y is at least the given one; its end_row if there is none.
  size_t row_from(const Slice& slice, int y) const {
    const auto first = rows_.begin() + static_cast<std::ptrdiff_t>(slice.first_row);
    const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(slice.end_row);
    return static_cast<size_t>(std::partition_point(first, end, [&](const Row& row) { return row.y < y; }) -
                               rows_.begin());
  }
  /// Number of active bricks below z.
  size_t bricks_below(int z) const {
    const size_t slice = slice_from(z);
    return slice < slices_.size() ? slices_[slice].begin : size();
  }
  /// Number of the gap (grid/gaps.h) that holds a brick of the box that is not active.
  size_t gap(Vec3i b) const;
  size_t gaps() const { return 2 * slices_.size() + 2 * rows_.size() + size() + 1; }
  /// Indices of the 27 bricks around a brick by neighbor_slot(), with the same two values for missing ones.
  const Neighbors& neighbors(size_t brick) const { return neighbors_[brick]; }

  size_t bytes() const {
    return size() * (sizeof(Vec3i) + sizeof(Neighbors)) + words_.bytes() + rows_.size() * sizeof(Row) +
           slices_.size() * sizeof(Slice);
  }

 private:
  /// 64 bricks along x, active or not, and the number of active bricks before them: so any brick is found in constant
  /// time (Jacobson 1989, "Space-efficient static trees and graphs": rank).
  struct Word {
    uint64_t bits = 0;
    int32_t before = 0;
    uint32_t gaps_before = 0;  ///< gaps of other rows and of empty space before the row
    /// Number of active bricks before a brick of the word.
    int32_t rank(Vec3i b) const { return before + count_bits(bits & ((uint64_t{1} << bit_in_word(b)) - 1)); }
  };
  void find_rows();
  void index_words();
  void find_neighbors(const Context& context);

  Vec3i bricks_;
  std::vector<Vec3i> coords_;
  std::vector<Row> rows_;
  std::vector<Slice> slices_;
  BrickWords<Word> words_;
  std::vector<Neighbors> neighbors_;
};

/// Sets all bricks of a grid in a mask of the same box.
void add_bricks(const BrickGrid& grid, BrickMask& mask);

/// The bricks of the next coarser level, in a box of `bricks`, that have any of their 8 children in a grid.
BrickMask parents_of(const BrickGrid& children, Vec3i bricks, const Context& context);

/// Bricks and those around them, also by an edge or a corner.
BrickMask with_neighbors(const BrickMask& bricks);

}  // namespace soapfilm
