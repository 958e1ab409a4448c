#include "soapfilm/grid/brick_grid.h"

namespace soapfilm {

BrickMask BrickMask::coarsened(Vec3i coarse_bricks) const {
  BrickMask coarse(coarse_bricks);
  for_each([&](Vec3i b) { coarse.set({b.x >> 1, b.y >> 1, b.z >> 1}); });
  return coarse;
}

BrickGrid::BrickGrid(const BrickMask& active, const Parallel& parallel) : bricks_(active.bricks()) {
  coords_.reserve(active.count());
  active.for_each([&](Vec3i b) { coords_.push_back(b); });

  words_.reserve(active.words().size() + 1);
  int32_t before = 0;
  for (const uint64_t bits : active.words()) {
    words_.push_back({bits, before});
    before += count_bits(bits);
  }
  words_.push_back({0, before});

  neighbors_.resize(coords_.size());
  parallel.for_each(coords_.size(), 1024, [&](size_t i) {
    for (int slot = 0; slot < 27; ++slot)
      neighbors_[i][static_cast<size_t>(slot)] = find(coords_[i] + slot_offset(slot));
  });
}

int32_t BrickGrid::gap(Vec3i b) const { return rank(BrickMask::index(bricks_, b)) + b.z * bricks_.y + b.y; }

}  // namespace soapfilm
