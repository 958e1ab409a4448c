#include "soapfilm/solve/closed_border.h"

#include <algorithm>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// visit(brick) for those of a range that lie at the ends of the bricks with free vertices.
template <class Visit>
void for_each_at_border(const BrickRange& free, const BrickRange& range, Visit&& visit) {
  for (int z = range.lo.z; z <= range.hi.z; ++z)
    for (int y = range.lo.y; y <= range.hi.y; ++y) {
      const bool whole = y == free.lo.y || y == free.hi.y || z == free.lo.z || z == free.hi.z;
      for (int x = whole ? range.lo.x : free.lo.x; x <= range.hi.x; x = whole || x == free.hi.x ? x + 1 : free.hi.x)
        if (x >= range.lo.x) visit(Vec3i{x, y, z});
    }
}

}  // namespace

Labels closed_at_border(const Labels& labels, const Context& context) {
  BrickMask band(labels.box.bricks);
  add_bricks(labels.grid, band);
  const BrickRange meant = bricks_with_free(labels.box);
  Labels closed;
  closed.box = labels.box;
  closed.places = labels.places;
  if (labels.places) {
    labels.places->for_each([&](Vec3i b) {
      const bool ends =
          meant.contains(b) && !(meant.contains(b - Vec3i{1, 1, 1}) && meant.contains(b + Vec3i{1, 1, 1}));
      if (ends && labels.inside.test(labels.grid, b)) band.set(b);
    });
    closed.grid = BrickGrid(band, context);
    closed.inside = labels.inside;
  } else {
    const Gaps gaps(labels.grid);
    for (size_t g = 0; g < gaps.size(); ++g)
      if (labels.inside[g]) for_each_at_border(meant, gaps[g].common(meant), [&](Vec3i brick) { band.set(brick); });
    closed.grid = BrickGrid(band, context);
    closed.inside = GapSides(closed.grid, meant, [&](Vec3i b) { return labels.inside.test(labels.grid, b); });
  }
  closed.bits.resize(closed.grid.size());
  parallel_for(context, closed.grid.size(), 64, [&](size_t b) {
    const Vec3i brick = closed.grid.coord(b);
    BrickBits& bits = closed.bits[b];
    if (const int32_t old = labels.grid.find(brick); old >= 0) {
      bits = labels.bits[static_cast<size_t>(old)];
      return;
    }
    bits = BrickBits::full();
    free_range(labels.box, brick).for_each_fixed({}, brick_side, [&](int x, int y, int z) {
      bits.clear(brick_offset(x, y, z));
    });
  });
  return closed;
}

}  // namespace soapfilm
