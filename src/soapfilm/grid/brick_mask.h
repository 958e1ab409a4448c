#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <mutex>
#include <vector>

#include "soapfilm/core/bits.h"
#include "soapfilm/grid/brick_range.h"
#include "soapfilm/grid/brick_words.h"

namespace soapfilm {

/// A set of bricks of a box: which ones are active, or supported by samples. Its memory follows the bricks that it
/// holds, not the box.
class BrickMask {
 public:
  BrickMask() = default;
  explicit BrickMask(Vec3i bricks) : bricks_(bricks) {}

  /// With every brick of a small box set.
  static BrickMask whole(Vec3i bricks) {
    BrickMask mask(bricks);
    BrickRange::whole(bricks).for_each([&](Vec3i b) { mask.set(b); });
    return mask;
  }

  Vec3i bricks() const { return bricks_; }
  bool contains(Vec3i b) const { return BrickRange::whole(bricks_).contains(b); }
  /// `b` must be in the box.
  bool test(Vec3i b) const {
    const uint64_t* bits = shard(word_of(b)).words.find(word_of(b));
    return bits && (*bits >> bit_in_word(b) & 1);
  }
  void set(Vec3i b, bool value = true) {
    const uint64_t bit = uint64_t{1} << bit_in_word(b);
    uint64_t& bits = shard(word_of(b)).words[word_of(b)];
    bits = value ? bits | bit : bits & ~bit;
  }
  /// set(b), which other threads may call at the same time.
  void set_shared(Vec3i b) {
    Shard& own = shard(word_of(b));
    const std::lock_guard held(own.lock.mutex);
    own.words[word_of(b)] |= uint64_t{1} << bit_in_word(b);
  }
  size_t count() const {
    size_t n = 0;
    for_each_word([&](Vec3i, uint64_t bits) { n += static_cast<size_t>(count_bits(bits)); });
    return n;
  }
  void operator|=(const BrickMask& other) {
    other.for_each_word([&](Vec3i word, uint64_t bits) { shard(word).words[word] |= bits; });
  }
  bool operator==(const BrickMask& other) const { return bricks_ == other.bricks_ && sorted() == other.sorted(); }

  /// Calls visit(b) for every set brick, x fastest, then y, then z.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const Word& word : sorted())
      for (uint64_t bits = word.bits; bits != 0; bits &= bits - 1)
        visit(brick_of_word(word.at, std::countr_zero(bits)));
  }

 private:
  /// A copy of it is free.
  struct Lock {
    Lock() = default;
    Lock(const Lock&) {}
    Lock& operator=(const Lock&) { return *this; }
    std::mutex mutex;
  };
  /// Threads mostly set bricks of different shards.
  struct Shard {
    Lock lock;
    BrickWords<uint64_t> words;
  };
  struct Word {
    Vec3i at;
    uint64_t bits;
    bool operator==(const Word&) const = default;
  };
  static constexpr int shard_bits = 4;

  static size_t shard_of(Vec3i word) { return BrickWords<uint64_t>::hash(word) & ((1u << shard_bits) - 1); }
  Shard& shard(Vec3i word) { return shards_[shard_of(word)]; }
  const Shard& shard(Vec3i word) const { return shards_[shard_of(word)]; }

  /// visit(word, bits), in no order.
  template <class Visit>
  void for_each_word(Visit&& visit) const {
    for (const Shard& part : shards_)
      for (const auto& entry : part.words.entries())
        if (entry.used() && entry.value != 0) visit(entry.word, entry.value);
  }
  std::vector<Word> sorted() const {
    std::vector<Word> words;
    for_each_word([&](Vec3i at, uint64_t bits) { words.push_back({at, bits}); });
    std::sort(words.begin(), words.end(), [](const Word& a, const Word& b) {
      return a.at.z != b.at.z ? a.at.z < b.at.z : a.at.y != b.at.y ? a.at.y < b.at.y : a.at.x < b.at.x;
    });
    return words;
  }

  Vec3i bricks_;
  std::array<Shard, 1 << shard_bits> shards_;
};

}  // namespace soapfilm
