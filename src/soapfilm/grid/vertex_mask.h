#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// One bit per vertex of a level's box of bricks. A byte is a brick's row: bit x of row(bx, y, z) is lattice vertex
/// (8 bx + x, y, z).
class VertexMask {
 public:
  VertexMask() = default;
  explicit VertexMask(Vec3i bricks)
      : bricks_(bricks), rows_(static_cast<size_t>(bricks.x) * bricks.y * bricks.z * brick_area, 0) {}

  Vec3i bricks() const { return bricks_; }
  Vec3i vertices() const { return bricks_ * brick_side; }
  /// False beyond the box.
  bool test(Vec3i v) const {
    const Vec3i n = vertices();
    if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= n.x || v.y >= n.y || v.z >= n.z) return false;
    return row(v.x >> 3, v.y, v.z) >> (v.x & 7) & 1;
  }
  /// `v` must be in the box.
  void set(Vec3i v) { row(v.x >> 3, v.y, v.z) |= static_cast<uint8_t>(1u << (v.x & 7)); }
  uint8_t& row(int bx, int y, int z) { return rows_[offset(bx, y, z)]; }
  uint8_t row(int bx, int y, int z) const { return rows_[offset(bx, y, z)]; }

  /// Also sets all vertices within `radius` along each axis (a cube).
  void dilate(int radius, const Context& context);
  void operator|=(const VertexMask& other) {
    for (size_t i = 0; i < rows_.size(); ++i) rows_[i] |= other.rows_[i];
  }
  void operator&=(const VertexMask& other) {
    for (size_t i = 0; i < rows_.size(); ++i) rows_[i] &= other.rows_[i];
  }
  bool operator==(const VertexMask&) const = default;
  bool empty() const {
    return std::all_of(rows_.begin(), rows_.end(), [](uint8_t row_bits) { return row_bits == 0; });
  }
  size_t count() const {
    size_t set_bits = 0;
    for (const uint8_t row_bits : rows_) set_bits += static_cast<size_t>(std::popcount(row_bits));
    return set_bits;
  }

  /// Calls visit(v) for every set vertex, x fastest, then y, then z.
  template <class Visit>
  void for_each(Visit&& visit) const {
    size_t i = 0;
    for (int z = 0; z < brick_side * bricks_.z; ++z)
      for (int y = 0; y < brick_side * bricks_.y; ++y)
        for (int bx = 0; bx < bricks_.x; ++bx)
          for (unsigned bits = rows_[i++]; bits != 0; bits &= bits - 1)
            visit(Vec3i{brick_side * bx + std::countr_zero(bits), y, z});
  }

 private:
  size_t offset(int bx, int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(brick_side * bricks_.y) + static_cast<size_t>(y)) *
               static_cast<size_t>(bricks_.x) +
           static_cast<size_t>(bx);
  }

  Vec3i bricks_;
  std::vector<uint8_t> rows_;
};

}  // namespace soapfilm
