// The blocks by which a surface is extracted. A block owns the cells and the edges whose lower vertex lies in its
// brick. All bricks of the grid are blocks, and so are the missing bricks just below them, whose last cells reach into
// the grid.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "soapfilm/core/bits.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/extract/drawn_cells.h"
#include "soapfilm/grid/brick_grid.h"

namespace soapfilm {

inline constexpr int words_per_block = static_cast<int>(BrickEdges{}.size());

/// Shifted by one: blocks may lie just below the box.
inline BrickMask mask_of_blocks(const BrickGrid& grid) {
  BrickMask mask(grid.bricks() + Vec3i{1, 1, 1});
  for (size_t b = 0; b < grid.size(); ++b) {
    for (int d = 0; d < 8; ++d) mask.set(grid.coord(b) + Vec3i{d & 1, d >> 1 & 1, d >> 2});
  }
  return mask;
}
inline Vec3i brick_of_block(const BrickGrid& blocks, size_t block) { return blocks.coord(block) - Vec3i{1, 1, 1}; }

/// Some of all blocks, and those of the next layer above the last of them: triangles have vertices there.
inline ItemRange with_next_layer(ItemRange some, const BrickGrid& blocks) {
  if (some.size() == 0) return some;
  return {some.begin, blocks.bricks_below(blocks.coord(some.end - 1).z + 2)};
}

/// The grid's bricks that the cells of some blocks reach, by layers.
inline ItemRange bricks_around(ItemRange some, const BrickGrid& blocks, const BrickGrid& grid) {
  if (some.size() == 0) return {};
  return {grid.bricks_below(std::max(0, brick_of_block(blocks, some.begin).z)),
          grid.bricks_below(brick_of_block(blocks, some.end - 1).z + 2)};
}

/// Which of a block's edges carry a surface point. Surface points are numbered in the order of the bits, so the index
/// of one follows from a count of the bits before it.
struct EdgePoints {
  BrickEdges bits;
  std::array<uint16_t, words_per_block> before;  ///< points in the block's earlier words

  uint32_t rank(int word, uint64_t lower) const {
    const auto w = static_cast<size_t>(word);
    return before[w] + static_cast<uint32_t>(count_bits(bits[w] & lower));
  }
};

}  // namespace soapfilm
