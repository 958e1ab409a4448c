#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <vector>

#include "soapfilm/core/bits.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// One bit per brick of a box of bricks: which ones are active, supported by samples, or inside.
class BrickMask {
 public:
  BrickMask() = default;
  explicit BrickMask(Vec3i bricks)
      : bricks_(bricks), words_((static_cast<size_t>(bricks.x) * bricks.y * bricks.z + 63) / 64, 0) {}

  /// With every brick of the box set.
  static BrickMask whole(Vec3i bricks) {
    BrickMask mask(bricks);
    for (uint64_t& w : mask.words_) w = ~uint64_t{0};
    if (const size_t rest = mask.volume() & 63; rest != 0) mask.words_.back() &= (uint64_t{1} << rest) - 1;
    return mask;
  }

  Vec3i bricks() const { return bricks_; }
  bool contains(Vec3i b) const {
    return b.x >= 0 && b.y >= 0 && b.z >= 0 && b.x < bricks_.x && b.y < bricks_.y && b.z < bricks_.z;
  }
  /// `b` must be in the box.
  bool test(Vec3i b) const {
    const size_t i = index(b);
    return (words_[i >> 6] >> (i & 63)) & 1u;
  }
  void set(Vec3i b, bool value = true) {
    const size_t i = index(b);
    const uint64_t bit = uint64_t{1} << (i & 63);
    words_[i >> 6] = value ? words_[i >> 6] | bit : words_[i >> 6] & ~bit;
  }
  /// set(b), which other threads may call at the same time.
  void set_shared(Vec3i b) {
    const size_t i = index(b);
    const std::atomic_ref<uint64_t> word(words_[i >> 6]);
    const uint64_t bit = uint64_t{1} << (i & 63);
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }
  size_t count() const {
    size_t n = 0;
    for (uint64_t w : words_) n += static_cast<size_t>(count_bits(w));
    return n;
  }
  void operator|=(const BrickMask& other) {
    for (size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
  }

  /// Calls visit(b) for every set brick, x fastest, then y, then z.
  template <class Visit>
  void for_each(Visit&& visit) const {
    const size_t row = static_cast<size_t>(bricks_.x);
    const size_t layer = row * bricks_.y;
    for (size_t w = 0; w < words_.size(); ++w) {
      for (uint64_t bits = words_[w]; bits != 0; bits &= bits - 1) {
        const size_t i = w * 64 + static_cast<size_t>(std::countr_zero(bits));
        visit(Vec3i{static_cast<int>(i % row), static_cast<int>(i / row % bricks_.y), static_cast<int>(i / layer)});
      }
    }
  }

  /// Bit i & 63 of word i >> 6 is the brick with index i.
  const std::vector<uint64_t>& words() const { return words_; }
  /// Index of a brick in a box of `bricks`: x fastest, then y, then z.
  static size_t index(Vec3i bricks, Vec3i b) {
    return (static_cast<size_t>(b.z) * bricks.y + static_cast<size_t>(b.y)) * bricks.x + static_cast<size_t>(b.x);
  }

 private:
  size_t index(Vec3i b) const { return index(bricks_, b); }
  size_t volume() const { return static_cast<size_t>(bricks_.x) * bricks_.y * bricks_.z; }

  Vec3i bricks_;
  std::vector<uint64_t> words_;
};

}  // namespace soapfilm
