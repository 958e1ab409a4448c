// Cells of space that triangles lie in, and a table of those that anything lies in.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// A cell's number: 21 bits for each coordinate, which lies within 2^20 of zero.
inline uint64_t cell_key(Vec3i cell) {
  const auto bits = [](int32_t i) { return static_cast<uint64_t>(i + (1 << 20)); };
  return bits(cell.x) << 42 | bits(cell.y) << 21 | bits(cell.z);
}

inline Vec3i cell_of(Vec3d p, double per_side) {
  const auto index = [&](double v) { return static_cast<int32_t>(std::floor(v * per_side)); };
  return {index(p.x), index(p.y), index(p.z)};
}

/// Keys in the order in which they came.
class CellTable {
 public:
  static constexpr uint32_t none = ~uint32_t{0};

  CellTable() : slots_(64, none) {}
  size_t size() const { return keys_.size(); }
  uint32_t find(uint64_t key) const {
    for (size_t i = hashed(key);; ++i) {
      const uint32_t found = slots_[i & (slots_.size() - 1)];
      if (found == none || keys_[found] == key) return found;
    }
  }
  uint32_t insert(uint64_t key) {
    if (const uint32_t found = find(key); found != none) return found;
    keys_.push_back(key);
    if (2 * keys_.size() > slots_.size()) {
      slots_.assign(2 * slots_.size(), none);
      for (uint32_t i = 0; i + 1 < keys_.size(); ++i) put(i);
    }
    put(static_cast<uint32_t>(keys_.size() - 1));
    return static_cast<uint32_t>(keys_.size() - 1);
  }

 private:
  static size_t hashed(uint64_t key) { return static_cast<size_t>((key * 0x9e3779b97f4a7c15u) >> 20); }
  void put(uint32_t number) {
    size_t i = hashed(keys_[number]);
    while (slots_[i & (slots_.size() - 1)] != none) ++i;
    slots_[i & (slots_.size() - 1)] = number;
  }

  std::vector<uint64_t> keys_;
  std::vector<uint32_t> slots_;
};

/// A convex polygon of few corners.
class Slice {
 public:
  Slice(Vec3d a, Vec3d b, Vec3d c) : corner_{a, b, c}, count_(3) {}

  /// The part with low <= coordinate <= high.
  Slice between(int axis, double low, double high) const { return cut(axis, low, 1).cut(axis, high, -1); }
  double least(int axis) const {
    double v = corner_[0][axis];
    for (int i = 1; i < count_; ++i) v = std::min(v, corner_[i][axis]);
    return v;
  }
  double most(int axis) const {
    double v = corner_[0][axis];
    for (int i = 1; i < count_; ++i) v = std::max(v, corner_[i][axis]);
    return v;
  }
  bool empty() const { return count_ == 0; }

 private:
  Slice() = default;
  Slice cut(int axis, double at, double side) const {
    Slice kept;
    for (int i = 0; i < count_; ++i) {
      const Vec3d p = corner_[i], q = corner_[(i + 1) % count_];
      const double hp = side * (p[axis] - at), hq = side * (q[axis] - at);
      if (hp >= 0) kept.corner_[kept.count_++] = p;
      if ((hp < 0) != (hq < 0) && hp != 0 && hq != 0) kept.corner_[kept.count_++] = p + (q - p) * (hp / (hp - hq));
    }
    return kept;
  }

  std::array<Vec3d, 8> corner_;
  int count_ = 0;
};

/// Visits the cells that the triangle widened by `margin` may lie in: all of them and few others. Cells are 1 /
/// `per_side` long.
template <class Visit>
void for_cells(Vec3d a, Vec3d b, Vec3d c, double margin, double per_side, Visit&& visit) {
  const Vec3d wide{margin, margin, margin};
  const Vec3d least{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
  const Vec3d most{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})};
  const Vec3i lo = cell_of(least - wide, per_side), hi = cell_of(most + wide, per_side);
  const Vec3i n = hi - lo + Vec3i{1, 1, 1};
  if (int64_t{n.x} * n.y * n.z <= 4 || n.x * int64_t{n.y} == 1 || n.y * int64_t{n.z} == 1 || n.x * int64_t{n.z} == 1) {
    for (int z = lo.z; z <= hi.z; ++z)
      for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x) visit(Vec3i{x, y, z});
    return;
  }
  const double side = 1 / per_side;
  const double around = margin + 1e-9 * side;
  const Slice whole(a, b, c);
  for (int z = lo.z; z <= hi.z; ++z) {
    const Slice layer = whole.between(2, z * side - around, (z + 1) * side + around);
    if (layer.empty()) continue;
    const int y0 = static_cast<int>(std::floor((layer.least(1) - around) * per_side));
    const int y1 = static_cast<int>(std::floor((layer.most(1) + around) * per_side));
    for (int y = y0; y <= y1; ++y) {
      const Slice row = layer.between(1, y * side - around, (y + 1) * side + around);
      if (row.empty()) continue;
      const int x0 = static_cast<int>(std::floor((row.least(0) - around) * per_side));
      const int x1 = static_cast<int>(std::floor((row.most(0) + around) * per_side));
      for (int x = x0; x <= x1; ++x) visit(Vec3i{x, y, z});
    }
  }
}

}  // namespace soapfilm
