#include "soapfilm/solve/closed_border.h"

#include <algorithm>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

Level closed_at_border(const Level& level, const Context& context) {
  BrickMask band(level.box.bricks);
  for (size_t b = 0; b < level.grid.size(); ++b) band.set(level.grid.coord(b));
  level.inside.for_each([&](Vec3i brick) {
    if (at_border(level.box, brick) && has_free(level.box, brick)) band.set(brick);
  });
  Level closed;
  closed.box = level.box;
  closed.lambda = level.lambda;
  closed.norm = level.norm;
  closed.grid = BrickGrid(band, context);
  closed.inside = level.inside;
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
