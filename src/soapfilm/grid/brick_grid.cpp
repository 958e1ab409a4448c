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
    ++row_begin_[row_of(b) + 1];
  });
  for (size_t row = 1; row < row_begin_.size(); ++row) row_begin_[row] += row_begin_[row - 1];

  neighbors_.resize(coords_.size());
  parallel.for_each(coords_.size(), 1024, [&](size_t i) {
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy) {
        const Vec3i first = coords_[i] + Vec3i{-1, dy, dz};
        size_t k = in_box(first.y, first.z) ? first_from(first) : coords_.size();
        for (int dx = -1; dx <= 1; ++dx) {
          const Vec3i b = coords_[i] + Vec3i{dx, dy, dz};
          const bool found = k < coords_.size() && coords_[k] == b;
          neighbors_[i][static_cast<size_t>(neighbor_slot(dx, dy, dz))] =
              found ? static_cast<int32_t>(k++) : missing(b);
        }
      }
  });
}

int32_t BrickGrid::find(Vec3i b) const {
  const int32_t none = missing(b);
  if (none == outside_box) return none;
  const size_t k = first_from(b);
  return k < coords_.size() && coords_[k] == b ? static_cast<int32_t>(k) : none;
}

int32_t BrickGrid::gap(Vec3i b) const { return static_cast<int32_t>(first_from(b) + row_of(b)); }

size_t BrickGrid::first_from(Vec3i b) const {
  const auto begin = coords_.begin() + row_begin_[row_of(b)];
  const auto end = coords_.begin() + row_begin_[row_of(b) + 1];
  return static_cast<size_t>(std::lower_bound(begin, end, b.x, [](const Vec3i& c, int x) { return c.x < x; }) -
                             coords_.begin());
}

}  // namespace soapfilm
