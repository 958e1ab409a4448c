// Levels whose u is drawn, not solved for.
#pragma once

#include "soapfilm/solve/level.h"
#include "support/dense.h"

namespace soapfilm::test {

/// u = 1 where inside(vertex). All bricks are in the band but those without a vertex, or without one of the other side,
/// when `sparse`.
template <class Inside>
Level drawn_level(const LevelBox& box, bool sparse, Inside&& inside) {
  static const Field<float> nothing;
  BrickMask band(box.bricks), full(box.bricks);
  BrickMask::whole(box.bricks).for_each([&](Vec3i b) {
    int count = 0;
    for_each_vertex(b, [&](Vec3i v, int) { count += inside(v); });
    if (!sparse || (count > 0 && count < brick_volume))
      band.set(b);
    else if (count == brick_volume)
      full.set(b);
  });
  const Context context(1);
  Level level = make_level(box, 1, band, BrickGrid(BrickMask(box.bricks), context), nothing, context);
  level.inside = GapSides(level.grid, bricks_with_free(box), [&](Vec3i b) { return full.test(b); });
  for (size_t b = 0; b < level.grid.size(); ++b)
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) { level.u.brick(b)[i] = inside(v) ? 1.0f : 0.0f; });
  return level;
}

}  // namespace soapfilm::test
