// What the places of a level are to the levels around.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// Of a brick whose parent has these: each vertex as the coarse one that holds it.
BrickBits bits_of_child(const BrickBits& parent, Vec3i brick);

/// visit(vertex, how many of the eight finer vertices that it holds are inside) for the vertices of a brick.
template <class Visit>
void for_each_with_children(const Labels& fine, Vec3i brick, Visit&& visit) {
  for (int k = 0; k < 8; ++k) {
    const BrickBits& children = fine.of(child_of(brick, k));
    const Vec3i base = octant_base(octant_of(k));
    for (int i = 0; i < octant_volume; ++i) {
      const Vec3i v{i % half_brick, i / half_brick % half_brick, i / (half_brick * half_brick)};
      int inside = 0;
      for (int c = 0; c < 8; ++c) {
        const Vec3i w = v * 2 + octant_of(c);
        inside += children.test(w.x, w.y, w.z);
      }
      visit(base + v, inside);
    }
  }
}

/// Of a brick whose children have these: each vertex as most of those that it holds.
BrickBits most_of_children(const Labels& fine, Vec3i parent);

/// The labels of a level in some places, on all bricks near its surface, and on the bricks around these beyond the
/// places those of the next coarser level: so the surface goes on where the places end.
Labels with_surroundings(const Labels& fine, const Labels& coarse, const Context& context);

}  // namespace soapfilm
