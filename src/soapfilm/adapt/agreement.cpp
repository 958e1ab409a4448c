#include "soapfilm/adapt/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/adapt/coarser_distance.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr int few = 16;  // vertices of a brick: a surface that differs by a voxel in a corner of it

/// Vertices of a coarse brick on one side of the coarse surface all of whose eight children are on the other.
int disagreeing(const DistanceField& coarse, const DistanceField& fine, Vec3i brick) {
  const int32_t own = coarse.grid.find(brick);
  const float* values = own >= 0 ? coarse.value.brick(static_cast<size_t>(own)) : nullptr;
  const float missing = values ? 0 : coarse.missing_value(brick);
  int count = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3i child = child_of(brick, k), base = octant_base(octant_of(k));
    const int32_t n = fine.grid.find(child);
    const float* children = n >= 0 ? fine.value.brick(static_cast<size_t>(n)) : nullptr;
    const bool all_inside = !children && fine.missing_value(child) > 0;
    for (int i = 0; i < octant_volume; ++i) {
      const Vec3i v{i % half_brick, i / half_brick % half_brick, i / (half_brick * half_brick)};
      const Vec3i at = base + v;
      const bool inside = (values ? values[brick_offset(at.x, at.y, at.z)] : missing) > 0;
      int same = 0;
      for (int c = 0; c < 8; ++c) {
        const Vec3i w = v * 2 + octant_of(c);
        same += (children ? children[brick_offset(w.x, w.y, w.z)] > 0 : all_inside) == inside;
      }
      count += same == 0;
    }
  }
  return count;
}

/// Of one level: the bricks from its border on in which it disagrees with the next finer one, connected; of those for
/// which may_go(brick).
template <class MayGo>
std::vector<Vec3i> from_border(const Regions& regions, int level, std::span<const DistanceField> levels,
                               const Context& context, MayGo&& may_go) {
  std::vector<Vec3i> bricks;
  regions.finer(level).for_each([&](Vec3i b) {
    if (may_go(b)) bricks.push_back(b);
  });
  std::vector<uint8_t> differs(bricks.size());
  parallel_for(context, bricks.size(), 64, [&](size_t b) {
    differs[b] =
        disagreeing(levels[static_cast<size_t>(level)], levels[static_cast<size_t>(level) - 1], bricks[b]) > few;
  });
  BrickMask open(regions.finer(level).bricks());  // not found yet
  for (size_t b = 0; b < bricks.size(); ++b)
    if (differs[b] != 0) open.set(bricks[b]);
  std::vector<Vec3i> found;
  const auto take = [&](Vec3i b) {
    open.set(b, false);
    found.push_back(b);
  };
  for (size_t b = 0; b < bricks.size(); ++b) {
    if (differs[b] == 0) continue;
    bool at_border = false;
    for (int slot = 0; slot < 27; ++slot)
      at_border = at_border || !regions.is_finer(level, bricks[b] + slot_offset(slot));
    if (at_border) take(bricks[b]);
  }
  for (size_t k = 0; k < found.size(); ++k)
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i n = found[k] + slot_offset(slot); open.contains(n) && open.test(n)) take(n);
  return found;
}

/// The finer level's field, in these bricks of the coarser one with that one's distances.
DistanceField with_values_of(const DistanceField& coarse, const std::vector<Vec3i>& bricks, DistanceField fine,
                             const Context& context) {
  BrickMask taken(fine.grid.bricks()), all(fine.grid.bricks());
  add_bricks(fine.grid, all);
  for (const Vec3i b : bricks)
    for (int k = 0; k < 8; ++k) taken.set(child_of(b, k));
  all |= taken;
  DistanceField mixed;
  mixed.grid = BrickGrid(all, context);
  mixed.value = Field<float>(mixed.grid, pages_of(context));
  mixed.inside = fine.inside.are_by_brick() ? fine.inside
                                            : GapSides(mixed.grid, BrickRange::whole(mixed.grid.bricks()),
                                                       [&](Vec3i b) { return fine.inside.test(fine.grid, b); });
  parallel_for(context, mixed.grid.size(), 64, [&](size_t b) {
    const Vec3i at = mixed.grid.coord(b);
    float* value = mixed.value.brick(b);
    if (!taken.test(at)) {
      std::copy_n(fine.value.brick(static_cast<size_t>(fine.grid.find(at))), brick_volume, value);
      return;
    }
    for (int i = 0; i < brick_volume; ++i)
      value[i] = std::clamp(2 * distance_at_finer(coarse, at * brick_side + vertex_in_brick(i)), -DistanceField::far,
                            DistanceField::far);
  });
  return mixed;
}

}  // namespace

void give_back_disagreement(Regions& regions, std::span<DistanceField> levels, const Context& context) {
  for (int l = regions.coarsest(); l >= 1; --l) {
    regions.give_back(l, from_border(regions, l, levels, context, [&](Vec3i b) { return !regions.is_asked(l, b); }));
    const auto needed = from_border(regions, l, levels, context, [&](Vec3i b) { return !regions.is_wanted(l, b); });
    DistanceField& fine = levels[static_cast<size_t>(l) - 1];
    if (needed.empty()) continue;
    fine = with_values_of(levels[static_cast<size_t>(l)], needed, std::move(fine), context);
    regions.follow(l, needed);
  }
}

}  // namespace soapfilm
