#include "soapfilm/grid/brick_grid.h"

#include <algorithm>

namespace soapfilm {

BrickMask BrickMask::coarsened(Vec3i coarse_bricks) const {
  BrickMask coarse(coarse_bricks);
  for_each([&](Vec3i b) { coarse.set({b.x >> 1, b.y >> 1, b.z >> 1}); });
  return coarse;
}

BrickGrid::BrickGrid(const BrickMask& active, const Parallel& parallel) : bricks_(active.bricks()) {
  coords_.reserve(active.count());
  row_begin_.assign(static_cast<size_t>(bricks_.y) * bricks_.z + 1, 0);
  active.for_each([&](Vec3i b) {
    coords_.push_back(b);
    ++row_begin_[static_cast<size_t>(b.z) * bricks_.y + static_cast<size_t>(b.y) + 1];
  });
  for (size_t row = 1; row < row_begin_.size(); ++row) row_begin_[row] += row_begin_[row - 1];

  neighbors_.resize(coords_.size());
  parallel.for_each(coords_.size(), 1024, [&](size_t i) {
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          neighbors_[i][neighbor_slot(dx, dy, dz)] = find(coords_[i] + Vec3i{dx, dy, dz});
  });
}

int32_t BrickGrid::find(Vec3i b) const {
  if (b.x < 0 || b.y < 0 || b.z < 0 || b.x >= bricks_.x || b.y >= bricks_.y || b.z >= bricks_.z) return outside_box;
  const size_t row = static_cast<size_t>(b.z) * bricks_.y + static_cast<size_t>(b.y);
  const auto begin = coords_.begin() + row_begin_[row];
  const auto end = coords_.begin() + row_begin_[row + 1];
  const auto it = std::lower_bound(begin, end, b.x, [](const Vec3i& c, int x) { return c.x < x; });
  return it != end && it->x == b.x ? static_cast<int32_t>(it - coords_.begin()) : outside_band;
}

}  // namespace soapfilm
