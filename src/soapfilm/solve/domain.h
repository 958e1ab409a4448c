// Where a level's values are: its box, the bricks that hold values, and the side of what lies between them.
#pragma once

#include <algorithm>
#include <memory>

#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/grid/brick_range.h"
#include "soapfilm/grid/gaps.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// Which vertices of a brick are free: local ranges [lo, hi) along each axis (8 wide when nothing is fixed).
struct FreeRange {
  Vec3i lo, hi;
  bool whole() const { return lo == Vec3i{0, 0, 0} && hi == Vec3i{brick_side, brick_side, brick_side}; }
  bool contains(int x, int y, int z) const {
    return x >= lo.x && x < hi.x && y >= lo.y && y < hi.y && z >= lo.z && z < hi.z;
  }
  /// visit(x, y, z) for the fixed ones among `side`^3 vertices from `first` on.
  template <class Visit>
  void for_each_fixed(Vec3i first, int side, Visit&& visit) const {
    if (whole()) return;
    for (int z = first.z; z < first.z + side; ++z)
      for (int y = first.y; y < first.y + side; ++y)
        for (int x = first.x; x < first.x + side; ++x)
          if (!contains(x, y, z)) visit(x, y, z);
  }
};
FreeRange free_range(const LevelBox& box, Vec3i brick);
/// The bricks with free vertices.
inline BrickRange bricks_with_free(const LevelBox& box) { return {brick_of(box.free_lo), brick_of(box.free_hi)}; }
/// Whether any vertex of the brick is free.
inline bool has_free(const LevelBox& box, Vec3i brick) { return bricks_with_free(box).contains(brick); }
/// Whether a vertex of the brick is fixed or next to a fixed one.
bool at_border(const LevelBox& box, Vec3i brick);
/// The nearest free vertex.
inline Vec3i nearest_free(const LevelBox& box, Vec3i v) {
  for (int axis = 0; axis < 3; ++axis) v[axis] = std::clamp(v[axis], box.free_lo[axis], box.free_hi[axis]);
  return v;
}

struct Domain {
  LevelBox box;
  BrickGrid grid;
  GapSides inside;  ///< for the gaps of the grid: the side of the surface
  /// The bricks that the domain covers; beyond them is what a coarser level says. Null: all of the box. If not, sides
  /// are by brick.
  std::shared_ptr<const BrickMask> places;

  bool covers(Vec3i brick) const { return !places || (places->contains(brick) && places->test(brick)); }

  /// The side of a brick that the grid lacks (slot value as BrickGrid::find() gives it). What lies beyond an open
  /// border is on no side, and counts as outside.
  bool is_inside(int32_t slot, Vec3i brick) const {
    return inside.test(grid, slot, brick) && (!box.open || has_free(box, brick));
  }
};

}  // namespace soapfilm
