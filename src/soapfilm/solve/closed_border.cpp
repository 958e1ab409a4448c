#include "soapfilm/solve/closed_border.h"

#include <algorithm>

#include "soapfilm/core/context_state.h"
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

Level closed_at_border(const Level& level, const Context& context) {
  BrickMask band(level.box.bricks);
  add_bricks(level.grid, band);
  const Gaps gaps(level.grid);
  const BrickRange meant = bricks_with_free(level.box);
  for (size_t g = 0; g < gaps.size(); ++g)
    if (level.inside[g]) for_each_at_border(meant, gaps[g].common(meant), [&](Vec3i brick) { band.set(brick); });
  Level closed;
  closed.box = level.box;
  closed.lambda = level.lambda;
  closed.norm = level.norm;
  closed.grid = BrickGrid(band, context);
  closed.inside = GapSides(closed.grid, meant, [&](Vec3i b) { return level.inside.test(level.grid, b); });
  closed.u = Field<float>(closed.grid, pages_of(context));
  parallel_for(context, closed.grid.size(), 64, [&](size_t b) {
    const Vec3i brick = closed.grid.coord(b);
    float* u = closed.u.brick(b);
    if (const int32_t old = level.grid.find(brick); old >= 0) {
      std::copy_n(level.u.brick(static_cast<size_t>(old)), brick_volume, u);
      return;
    }
    std::fill_n(u, brick_volume, 1.0f);
    free_range(level.box, brick).for_each_fixed({}, brick_side, [&](int x, int y, int z) {
      u[brick_offset(x, y, z)] = 0;
    });
  });
  return closed;
}

}  // namespace soapfilm
