// One value at every vertex of a level's box, for solvers without a band.
#pragma once

#include <cstddef>

#include "soapfilm/grid/field.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// A box of values in one flat array, x fastest: the level's free vertices and one layer of fixed ones around them, so
/// the finest level has as many values along each axis as the lattice reports vertices. Initially zero.
template <class T>
class DenseField {
 public:
  DenseField() = default;
  explicit DenseField(const LevelBox& box, const PagePool& pages = {})
      : origin_(box.free_lo - Vec3i{1, 1, 1}),
        size_(box.free_hi - box.free_lo + Vec3i{3, 3, 3}),
        values_(static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z), pages) {}

  /// Lattice coordinates (of this level) of the first value.
  Vec3i origin() const { return origin_; }
  Vec3i size() const { return size_; }
  size_t count() const { return values_.size(); }
  size_t bytes() const { return values_.bytes(); }
  /// Distance in the array between neighbors along an axis: the constant neighbor offsets of the paper's remarks.
  size_t stride(int axis) const {
    return axis == 0 ? 1 : static_cast<size_t>(size_.x) * (axis == 1 ? 1 : static_cast<size_t>(size_.y));
  }

  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  /// First value of the row (y, z), counted from the origin.
  T* row(int y, int z) { return data() + row_offset(y, z); }
  const T* row(int y, int z) const { return data() + row_offset(y, z); }

  /// `vertex` in lattice coordinates of this level.
  bool contains(Vec3i vertex) const {
    const Vec3i v = vertex - origin_;
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size_.x && v.y < size_.y && v.z < size_.z;
  }
  /// `vertex` must be contained.
  T& at(Vec3i vertex) { return data()[offset(vertex)]; }
  const T& at(Vec3i vertex) const { return data()[offset(vertex)]; }
  /// Zero beyond the box.
  T get(Vec3i vertex) const { return contains(vertex) ? at(vertex) : T{}; }

 private:
  size_t row_offset(int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(size_.y) + static_cast<size_t>(y)) *
           static_cast<size_t>(size_.x);
  }
  size_t offset(Vec3i vertex) const {
    const Vec3i v = vertex - origin_;
    return row_offset(v.y, v.z) + static_cast<size_t>(v.x);
  }

  Vec3i origin_;
  Vec3i size_;
  AlignedArray<T> values_;
};

/// The part of the box that a brick covers: `visit(row, x, y, z, n)` for every run of n values, where `row` begins at
/// position x of the brick's row (y, z).
template <class T, class Visit>
void for_each_run(DenseField<T>& field, Vec3i brick, Visit&& visit) {
  const Vec3i first = brick * brick_side - field.origin();
  const int x0 = first.x < 0 ? -first.x : 0;
  const int x1 = field.size().x - first.x < brick_side ? field.size().x - first.x : brick_side;
  if (x0 >= x1) return;
  for (int z = 0; z < brick_side; ++z) {
    if (first.z + z < 0 || first.z + z >= field.size().z) continue;
    for (int y = 0; y < brick_side; ++y) {
      if (first.y + y < 0 || first.y + y >= field.size().y) continue;
      visit(field.row(first.y + y, first.z + z) + first.x + x0, x0, y, z, x1 - x0);
    }
  }
}
template <class T, class Visit>
void for_each_run(const DenseField<T>& field, Vec3i brick, Visit&& visit) {
  for_each_run(const_cast<DenseField<T>&>(field), brick,
               [&](const T* row, int x, int y, int z, int n) { visit(row, x, y, z, n); });
}

}  // namespace soapfilm
