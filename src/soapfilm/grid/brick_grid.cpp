#include "soapfilm/grid/brick_grid.h"

#include "soapfilm/core/parallel.h"

namespace soapfilm {

BrickGrid::BrickGrid(const BrickMask& active, const Context& context) : bricks_(active.bricks()) {
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
  parallel_for(context, coords_.size(), 1024, [&](size_t i) {
    for (int slot = 0; slot < 27; ++slot)
      neighbors_[i][static_cast<size_t>(slot)] = find(coords_[i] + slot_offset(slot));
  });
}

BrickMask parents_of(const BrickGrid& children, Vec3i bricks, const Context& context) {
  BrickMask parents(bricks);
  parallel_for(context, children.size(), 256, [&](size_t b) { parents.set_shared(parent_of(children.coord(b))); });
  return parents;
}

int32_t BrickGrid::gap(Vec3i b) const { return rank(BrickMask::index(bricks_, b)) + b.z * bricks_.y + b.y; }

}  // namespace soapfilm
