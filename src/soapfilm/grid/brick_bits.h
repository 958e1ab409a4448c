#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/grid/layout.h"

namespace soapfilm {

/// One bit per vertex of a brick: bit x + 8 y of word z.
struct BrickBits {
  std::array<uint64_t, brick_side> layer{};

  static BrickBits full() { return ~BrickBits{}; }
  /// Of the brick's 512 values, those above a threshold.
  static BrickBits above(const float* values, float threshold) {
    static_assert(std::endian::native == std::endian::little);
    std::array<uint8_t, brick_volume> above;
    for (int i = 0; i < brick_volume; ++i) above[static_cast<size_t>(i)] = values[i] > threshold;
    BrickBits bits;
    for (size_t row = 0; row < brick_area; ++row) {
      uint64_t bytes;  // the first vertex in the lowest one
      std::memcpy(&bytes, above.data() + brick_side * row, brick_side);
      const uint64_t byte = bytes * 0x0102040810204080 >> 56;  // byte x is moved to bit 56 + x
      bits.layer[row / brick_side] |= byte << brick_side * (row % brick_side);
    }
    return bits;
  }

  bool test(int x, int y, int z) const { return layer[static_cast<size_t>(z)] >> (x + brick_side * y) & 1; }
  /// Bit x for vertex x.
  uint8_t row(int y, int z) const { return static_cast<uint8_t>(layer[static_cast<size_t>(z)] >> brick_side * y); }
  void set(int offset) { layer[static_cast<size_t>(offset / brick_area)] |= uint64_t{1} << offset % brick_area; }
  void clear(int offset) { layer[static_cast<size_t>(offset / brick_area)] &= ~(uint64_t{1} << offset % brick_area); }
  bool any() const {
    uint64_t bits = 0;
    for (const uint64_t word : layer) bits |= word;
    return bits != 0;
  }
  size_t count() const {
    size_t n = 0;
    for (const uint64_t word : layer) n += static_cast<size_t>(count_bits(word));
    return n;
  }
  /// Only the first set bit.
  BrickBits first() const {
    BrickBits one;
    for (size_t z = 0; z < layer.size(); ++z)
      if (layer[z] != 0) {
        one.layer[z] = layer[z] & (~layer[z] + 1);
        break;
      }
    return one;
  }
  /// Calls visit(offset in the brick) for every set bit, in order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (size_t z = 0; z < layer.size(); ++z)
      for (uint64_t bits = layer[z]; bits != 0; bits &= bits - 1)
        visit(static_cast<int>(z) * brick_area + std::countr_zero(bits));
  }

  bool operator==(const BrickBits&) const = default;
  BrickBits operator~() const {
    BrickBits out;
    for (size_t z = 0; z < layer.size(); ++z) out.layer[z] = ~layer[z];
    return out;
  }
  BrickBits& operator|=(const BrickBits& other) {
    for (size_t z = 0; z < layer.size(); ++z) layer[z] |= other.layer[z];
    return *this;
  }
  BrickBits& operator&=(const BrickBits& other) {
    for (size_t z = 0; z < layer.size(); ++z) layer[z] &= other.layer[z];
    return *this;
  }
  BrickBits& operator^=(const BrickBits& other) {
    for (size_t z = 0; z < layer.size(); ++z) layer[z] ^= other.layer[z];
    return *this;
  }
  friend BrickBits operator^(BrickBits a, const BrickBits& b) { return a ^= b; }
  friend BrickBits operator|(BrickBits a, const BrickBits& b) { return a |= b; }
  friend BrickBits operator&(BrickBits a, const BrickBits& b) { return a &= b; }
};

/// The bits moved by one vertex along an axis, up (step 1) or down (-1); bits that leave the brick are lost.
inline BrickBits moved(const BrickBits& bits, int axis, int step) {
  constexpr uint64_t lowest_x = 0x0101010101010101, highest_x = lowest_x << 7;
  BrickBits out;
  for (size_t z = 0; z < bits.layer.size(); ++z) {
    const uint64_t word = bits.layer[z];
    if (axis == 0)
      out.layer[z] = step > 0 ? (word & ~highest_x) << 1 : (word & ~lowest_x) >> 1;
    else if (axis == 1)
      out.layer[z] = step > 0 ? word << brick_side : word >> brick_side;
    else if (step > 0 ? z + 1 < bits.layer.size() : z > 0)
      out.layer[step > 0 ? z + 1 : z - 1] = word;
  }
  return out;
}

/// The bits lost by moved(), at their place in the next brick.
inline BrickBits carried(const BrickBits& bits, int axis, int step) {
  constexpr uint64_t lowest_x = 0x0101010101010101;
  constexpr int last = brick_side - 1;
  BrickBits out;
  if (axis == 2) {
    out.layer[step > 0 ? 0 : last] = bits.layer[step > 0 ? last : 0];
    return out;
  }
  for (size_t z = 0; z < bits.layer.size(); ++z) {
    const uint64_t word = bits.layer[z];
    if (axis == 0)
      out.layer[z] = step > 0 ? word >> last & lowest_x : (word & lowest_x) << last;
    else
      out.layer[z] = step > 0 ? word >> brick_side * last : word << brick_side * last;
  }
  return out;
}

}  // namespace soapfilm
