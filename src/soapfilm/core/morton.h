// Morton keys: the bits of three coordinates interleaved, so that cells near each other are close in order, and the key
// of the coarser cell around a cell is the key without its last three bits.
#pragma once

#include <algorithm>
#include <cstdint>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The lowest 21 bits of v, each followed by two zeros.
constexpr uint64_t spread_coordinate(uint64_t v) {
  v &= 0x1FFFFF;
  v = (v | v << 32) & 0x1F00000000FFFFull;
  v = (v | v << 16) & 0x1F0000FF0000FFull;
  v = (v | v << 8) & 0x100F00F00F00F00Full;
  v = (v | v << 4) & 0x10C30C30C30C30C3ull;
  v = (v | v << 2) & 0x1249249249249249ull;
  return v;
}

/// The inverse: every third bit, from the lowest on.
constexpr int gather_coordinate(uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10C30C30C30C30C3ull;
  v = (v | v >> 4) & 0x100F00F00F00F00Full;
  v = (v | v >> 8) & 0x1F0000FF0000FFull;
  v = (v | v >> 16) & 0x1F00000000FFFFull;
  v = (v | v >> 32) & 0x1FFFFF;
  return static_cast<int>(v);
}

/// The cell of a cube's grid of 2^depth cells along each axis that holds a position; depth in [0, 21]. `from_corner` is
/// relative to the cube's lowest corner, in lengths of its side, each coordinate >= 0; 1 belongs to the last cell.
inline uint64_t morton_key(Vec3d from_corner, int depth) {
  const auto cells = static_cast<double>(1 << depth);
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis)
    key |= spread_coordinate(static_cast<uint64_t>(std::min(from_corner[axis] * cells, cells - 1))) << axis;
  return key;
}

}  // namespace soapfilm
