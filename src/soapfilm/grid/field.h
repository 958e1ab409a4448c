// Values on the bricks of a grid: one flat array per quantity.
#pragma once

#include <cstddef>
#include <type_traits>

#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/platform/page_pool.h"

namespace soapfilm {

/// An array of zeros, aligned to 64 bytes. The 64 bytes before the first and after the last value may be read: a vector
/// load may extend beyond a row's ends.
template <class T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  AlignedArray() = default;
  explicit AlignedArray(size_t count, const PagePool& pages = {}) : count_(count), pages_(pages) {
    if (count > 0) memory_ = pages.allocate(lead_bytes + count * sizeof(T) + lead_bytes);
  }

  size_t size() const { return count_; }
  size_t bytes() const { return count_ * sizeof(T); }
  T* data() { return memory_ ? reinterpret_cast<T*>(memory_.get() + lead_bytes) : nullptr; }
  const T* data() const { return memory_ ? reinterpret_cast<const T*>(memory_.get() + lead_bytes) : nullptr; }
  /// Values before `end` are not read any more: frees their memory early.
  void release_before(size_t end) { released_ = release_pages(memory_, released_, lead_bytes + end * sizeof(T)); }
  /// Of an array on disk: values [begin, end) will soon be used.
  void fetch(size_t begin, size_t end) const {
    if (on_disk()) fetch_pages(memory_, lead_bytes + begin * sizeof(T), lead_bytes + end * sizeof(T));
  }
  bool on_disk() const { return memory_ && memory_.get_deleter().file >= 0; }
  /// Values [begin, end), still zero, will soon be written.
  void supply_pages(size_t begin, size_t end) { pages_.supply(data() + begin, (end - begin) * sizeof(T)); }

 private:
  static constexpr size_t lead_bytes = 64;
  size_t count_ = 0;
  size_t released_ = 0;  // bytes, lead included
  PagePool pages_;
  ZeroedMemory memory_;
};

/// `components` values of type T at each vertex of a grid's bricks: brick after brick, in a brick component after
/// component, 512 values each. Valid only for the grid for which it was made; initially zero.
template <class T, int components = 1>
class Field {
 public:
  static constexpr size_t values_per_brick = static_cast<size_t>(components) * brick_volume;

  Field() = default;
  explicit Field(size_t bricks, const PagePool& pages = {}) : values_(bricks * values_per_brick, pages) {}
  explicit Field(const BrickGrid& grid, const PagePool& pages = {}) : Field(grid.size(), pages) {}

  size_t bricks() const { return values_.size() / values_per_brick; }
  T* brick(size_t b, int component = 0) { return values_.data() + b * values_per_brick + component * brick_volume; }
  const T* brick(size_t b, int component = 0) const {
    return values_.data() + b * values_per_brick + component * brick_volume;
  }
  size_t bytes() const { return values_.bytes(); }
  /// Bricks before `end` are not read any more: frees their memory early.
  void release_before(size_t end) { values_.release_before(end * values_per_brick); }
  /// Of an array on disk: bricks [begin, end) will soon be used.
  void fetch(size_t begin, size_t end) const { values_.fetch(begin * values_per_brick, end * values_per_brick); }
  bool on_disk() const { return values_.on_disk(); }
  /// Bricks [begin, end), still zero, will soon be written.
  void supply_pages(size_t begin, size_t end) {
    values_.supply_pages(begin * values_per_brick, end * values_per_brick);
  }

 private:
  AlignedArray<T> values_;
};

}  // namespace soapfilm
