#include "soapfilm/adapt/leaf_links.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/solve/domain.h"

namespace soapfilm {

size_t LeafSet::count() const {
  size_t n = 0;
  for (const BrickBits& brick : bits) n += brick.count();
  return n;
}

bool LeafSet::any() const {
  return std::any_of(bits.begin(), bits.end(), [](const BrickBits& brick) { return brick.any(); });
}

LeafLinks::LeafLinks(const Regions& regions, const Lattice& lattice, const GraphCutSetup& setup, double lambda,
                     const Context& context)
    : regions_(regions), levels_(static_cast<size_t>(regions.coarsest()) + 1) {
  for (int l = 0; l <= regions.coarsest(); ++l) {
    OfLevel& level = levels_[static_cast<size_t>(l)];
    level.box = lattice.box(l);
    level.lambda = std::ldexp(lambda, 2 * (l - lattice.added));
    level.links = graph_links(setup, level.lambda);
    BrickMask leaves(level.box.bricks);
    const auto add = [&](Vec3i b) {
      if (regions.has(l, b) && has_free(level.box, b)) leaves.set(b);
    };
    if (l == regions.coarsest())
      bricks_with_free(level.box).for_each(add);
    else
      children_of(regions.finer(l + 1), level.box.bricks).for_each(add);
    level.grid = BrickGrid(leaves, context);
    level.whole.resize(level.grid.size());
    for (size_t b = 0; b < level.grid.size(); ++b) level.whole[b] = free_range(level.box, level.grid.coord(b)).whole();
    level.first = level_of_.size();
    level_of_.resize(level.first + level.grid.size(), static_cast<uint8_t>(l));
  }
}

size_t LeafLinks::find(int level, Vec3i brick) const {
  const int32_t n = at(level).grid.find(brick);
  return n < 0 ? bricks() : at(level).first + static_cast<size_t>(n);
}

BrickBits LeafLinks::free(size_t brick) const {
  const FreeRange range = free_range(box(level(brick)), coord(brick));
  BrickBits bits = BrickBits::full();
  range.for_each_fixed({}, brick_side, [&](int x, int y, int z) { bits.clear(brick_offset(x, y, z)); });
  return bits;
}

uint64_t LeafLinks::bytes() const {
  uint64_t sum = level_of_.size();
  for (const OfLevel& level : levels_) sum += level.grid.bytes();
  return sum;
}

LeafLinks::End LeafLinks::end_at(int level, Vec3i vertex, int32_t n, Leaf& found) const {
  const Vec3i brick = brick_of(vertex);
  const OfLevel& own = at(level);
  if (n >= 0) {
    found = {own.first + static_cast<size_t>(n), brick_offset(vertex.x & 7, vertex.y & 7, vertex.z & 7)};
    return own.box.is_free(vertex) ? End::leaf : End::fixed;
  }
  if (!BrickRange::whole(own.box.bricks).contains(brick)) return End::fixed;
  if (regions_.is_finer(level, brick)) return End::finer;
  if (regions_.has(level, brick)) return End::fixed;
  const Vec3i parent = parent_of(vertex);
  const size_t coarser = find(level + 1, brick_of(parent));
  if (coarser == bricks()) return End::fixed;
  found = {coarser, brick_offset(parent.x & 7, parent.y & 7, parent.z & 7)};
  return box(level + 1).is_free(parent) ? End::leaf : End::fixed;
}

}  // namespace soapfilm
