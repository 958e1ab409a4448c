// A hash table by words of 64 bricks along x: what sparse sets of bricks are made of.
#pragma once

#include <bit>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// A brick's word, and its bit in there.
inline constexpr int word_bits = 6;
constexpr Vec3i word_of(Vec3i brick) { return {brick.x >> word_bits, brick.y, brick.z}; }
constexpr int bit_in_word(Vec3i brick) { return brick.x & ((1 << word_bits) - 1); }
constexpr Vec3i brick_of_word(Vec3i word, int bit) { return {(word.x << word_bits) + bit, word.y, word.z}; }

/// From words to values, in no order. Open addressing; at most half full.
template <class T>
class BrickWords {
 public:
  struct Entry {
    Vec3i word{0, 0, INT_MIN};  ///< this one: empty
    T value{};
    bool used() const { return word.z != INT_MIN; }
  };

  size_t size() const { return size_; }
  size_t bytes() const { return entries_.size() * sizeof(Entry); }
  const std::vector<Entry>& entries() const { return entries_; }  ///< empty ones too
  void reserve(size_t words) {
    if (2 * words > entries_.size()) rehash(std::bit_ceil(2 * words));
  }

  const T* find(Vec3i word) const {
    if (entries_.empty()) return nullptr;
    const Entry& entry = entries_[place(word)];
    return entry.used() ? &entry.value : nullptr;
  }
  /// Made if it is not there.
  T& operator[](Vec3i word) {
    if (2 * (size_ + 1) > entries_.size()) rehash(entries_.empty() ? 8 : 2 * entries_.size());
    Entry& entry = entries_[place(word)];
    if (!entry.used()) {
      entry.word = word;
      ++size_;
    }
    return entry.value;
  }

  static uint64_t hash(Vec3i word) {
    const auto bits = [](int c) { return static_cast<uint64_t>(static_cast<uint32_t>(c)); };
    const uint64_t mixed = (bits(word.x) * 0x9E3779B97F4A7C15 + bits(word.y)) * 0xBF58476D1CE4E5B9 + bits(word.z);
    return mixed * 0x94D049BB133111EB;
  }

 private:
  /// Where the word is, or where it would be put.
  size_t place(Vec3i word) const {
    size_t i = hash(word) >> shift_;
    while (entries_[i].used() && !(entries_[i].word == word)) i = (i + 1) & (entries_.size() - 1);
    return i;
  }
  void rehash(size_t capacity) {
    std::vector<Entry> old(capacity);
    old.swap(entries_);
    shift_ = 64 - std::countr_zero(capacity);
    for (const Entry& entry : old)
      if (entry.used()) entries_[place(entry.word)] = entry;
  }

  std::vector<Entry> entries_;  // a power of two of them
  size_t size_ = 0;
  int shift_ = 64;
};

}  // namespace soapfilm
