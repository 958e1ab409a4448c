// Copies of a brick together with a margin of its neighbors, for stencils wider than one vertex.
#pragma once

#include <algorithm>
#include <array>

#include "soapfilm/grid/brick_grid.h"

namespace soapfilm {

/// A cube of (8 + 2 margin)^3 values, x fastest; (0, 0, 0) is the brick's vertex (-margin, -margin, -margin).
template <class T, int margin>
struct Window {
  static_assert(margin >= 0 && margin <= brick_side);
  static constexpr int side = brick_side + 2 * margin;
  std::array<T, static_cast<size_t>(side) * side * side> values;

  /// Coordinates relative to the brick: each in [-margin, 8 + margin).
  T& at(int x, int y, int z) { return values[static_cast<size_t>(offset(x, y, z))]; }
  const T& at(int x, int y, int z) const { return values[static_cast<size_t>(offset(x, y, z))]; }
  static constexpr int offset(int x, int y, int z) {
    return (x + margin) + side * ((y + margin) + side * (z + margin));
  }
};

/// Fills a window around `brick`. source(slot, neighbor) returns the 512 values of the neighbor in that slot (see
/// neighbor_slot), or null if it is missing; then missing(slot, neighbor) returns one value for that whole part.
template <class T, int margin, class Source, class Missing>
void fill_window(const BrickGrid& grid, size_t brick, Source&& source, Missing&& missing, Window<T, margin>& window) {
  const BrickGrid::Neighbors& neighbors = grid.neighbors(brick);
  struct Span {
    int first, last;
  };
  // Along an axis the lower neighbor covers [-margin, 0), the brick [0, 8), the upper one [8, 8 + margin).
  constexpr Span spans[3] = {{-margin, 0}, {0, brick_side}, {brick_side, brick_side + margin}};
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int slot = neighbor_slot(dx, dy, dz);
        const Span sx = spans[dx + 1], sy = spans[dy + 1], sz = spans[dz + 1];
        const auto* values = source(slot, neighbors[slot]);
        const T fill = values ? T{} : static_cast<T>(missing(slot, neighbors[slot]));
        for (int z = sz.first; z < sz.last; ++z) {
          for (int y = sy.first; y < sy.last; ++y) {
            T* out = &window.at(sx.first, y, z);
            if (values) {
              const auto* in = values + brick_offset(sx.first & 7, y & 7, z & 7);
              for (int i = 0; i < sx.last - sx.first; ++i) out[i] = static_cast<T>(in[i]);
            } else {
              std::fill(out, out + (sx.last - sx.first), fill);
            }
          }
        }
      }
    }
  }
}

}  // namespace soapfilm
