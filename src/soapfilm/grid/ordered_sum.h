// Sums over bricks whose value depends on where the bricks are in the lattice and on nothing else: not on threads, not
// on how bricks are numbered, and not on which of the other tiles are computed where.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"
#include "soapfilm/grid/brick_grid.h"

namespace soapfilm {

/// The terms of each tile's bricks are added in lattice order (x fastest, then y, then z), then the tiles' sums in that
/// order. T{} is 0.
template <class T>
class TileSums {
 public:
  /// Bricks of the same tile in lattice order; other tiles' bricks may come between.
  void add(Vec3i brick, const T& term) {
    const Key key{brick.z >> tile_bits, brick.y >> tile_bits, brick.x >> tile_bits};
    if (!last_ || key != last_key_) {
      last_ = &tiles_[key];
      last_key_ = key;
    }
    *last_ += term;
  }
  T total() const {
    T sum{};
    for (const auto& [key, of_tile] : tiles_) sum += of_tile;
    return sum;
  }

 private:
  using Key = std::array<int, 3>;  // z first: the order of the map
  std::map<Key, T> tiles_;
  Key last_key_{};
  T* last_ = nullptr;
};

/// The sum of the terms of bricks coord(b), b < terms.size(), which are in lattice order.
template <class T, class Coord>
T ordered_sum(const std::vector<T>& terms, Coord&& coord) {
  TileSums<T> sums;
  for (size_t b = 0; b < terms.size(); ++b) sums.add(coord(b), terms[b]);
  return sums.total();
}

/// The same of term(b), b < count, which all threads compute.
template <class T, class Coord, class Term>
T ordered_sum(size_t count, const Context& context, Coord&& coord, Term&& term) {
  std::vector<T> terms(count);
  parallel_for(context, count, 256, [&](size_t b) { terms[b] = term(b); });
  return ordered_sum(terms, coord);
}

/// The sum of term(b) over the bricks of a grid.
template <class T, class Term>
T ordered_sum(const BrickGrid& grid, const Context& context, Term&& term) {
  return ordered_sum<T>(
      grid.size(), context, [&](size_t b) { return grid.coord(b); }, term);
}

/// The sum of terms that are there already.
template <class T>
T ordered_sum(const BrickGrid& grid, const std::vector<T>& terms) {
  return ordered_sum(terms, [&](size_t b) { return grid.coord(b); });
}

/// Whether a brick belongs to a subsample of one in `stride` bricks, chosen by its place alone.
inline bool is_sampled(Vec3i brick, size_t stride) {
  const auto bits = [](int c) { return static_cast<uint64_t>(static_cast<uint32_t>(c)); };
  const uint64_t place = Random(bits(brick.x) | bits(brick.y) << 32).next() + bits(brick.z);
  return Random(place).next() % stride == 0;
}

}  // namespace soapfilm
