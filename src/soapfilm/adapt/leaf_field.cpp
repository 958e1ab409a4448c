#include "soapfilm/adapt/leaf_field.h"

#include <algorithm>
#include <array>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

enum class Side : uint8_t { outside, inside, both };

class Joined {
 public:
  Joined(const Regions& regions, std::span<const DistanceField> levels) : regions_(regions), levels_(levels) {}

  const DistanceField& level(int l) const { return levels_[static_cast<size_t>(l)]; }

  Side side(int l, Vec3i brick) const {
    const DistanceField& field = level(l);
    if (field.grid.find(brick) >= 0) return Side::both;
    return field.inside.test(field.grid, brick) ? Side::inside : Side::outside;
  }

  /// Whether a place around a brick of one side has the other one.
  bool meets_other_side(int l, Vec3i brick, Side own, Vec3i box) const {
    const auto differs = [own](Side other) { return other != Side::both && other != own; };
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i n = brick + slot_offset(slot);
      if (!BrickRange::whole(box).contains(n)) continue;
      if (regions_.has(l, n)) {
        if (differs(side(l, n))) return true;
      } else if (regions_.is_finer(l, n)) {
        for (int k = 0; k < 8; ++k)
          if (differs(side(l - 1, child_of(n, k)))) return true;
      } else if (differs(side(l + 1, parent_of(n)))) {
        return true;
      }
    }
    return false;
  }

  /// The bricks of a level at the borders of its places.
  std::vector<Vec3i> at_borders(int l) const {
    std::vector<Vec3i> found;
    // Beside finer places.
    if (l > 0)
      regions_.finer(l).for_each([&](Vec3i b) {
        for (int slot = 0; slot < 27; ++slot) {
          const Vec3i n = b + slot_offset(slot);
          if (regions_.finer(l).contains(n) && regions_.has(l, n)) found.push_back(n);
        }
      });
    // Beside coarser ones.
    if (l < regions_.coarsest())
      regions_.finer(l + 1).for_each([&](Vec3i parent) {
        bool inner = true;
        for (int slot = 0; slot < 27; ++slot) inner = inner && regions_.is_finer(l + 1, parent + slot_offset(slot));
        for (int k = 0; k < 8 && !inner; ++k)
          if (const Vec3i child = child_of(parent, k); regions_.has(l, child)) found.push_back(child);
      });
    return found;
  }

 private:
  const Regions& regions_;
  std::span<const DistanceField> levels_;
};

}  // namespace

LeafField join_levels(const Regions& regions, std::span<const DistanceField> levels, const Lattice& lattice,
                      const Context& context) {
  const Joined joined(regions, levels);
  LeafField field;
  for (int l = 0; l <= regions.coarsest(); ++l) {
    const Vec3i box = lattice.box(l).bricks;
    const DistanceField& own = joined.level(l);
    BrickMask mask(box);
    for (size_t b = 0; b < own.grid.size(); ++b)
      if (regions.has(l, own.grid.coord(b))) mask.set(own.grid.coord(b));
    for (const Vec3i b : joined.at_borders(l))
      if (const Side side = joined.side(l, b); side != Side::both && joined.meets_other_side(l, b, side, box))
        mask.set(b);
    BrickGrid grid(mask, context);
    Field<float> distance(grid, pages_of(context));
    parallel_for(context, grid.size(), 64, [&](size_t b) {
      const int32_t from = own.grid.find(grid.coord(b));
      if (from >= 0)
        std::copy_n(own.value.brick(static_cast<size_t>(from)), brick_volume, distance.brick(b));
      else
        std::fill_n(distance.brick(b), brick_volume, own.missing_value(grid.coord(b)));
    });
    field.grids.push_back(std::move(grid));
    field.distances.push_back(std::move(distance));
  }
  return field;
}

bool side_of_region(const Regions& regions, std::span<const DistanceField> levels, int level, Vec3i vertex) {
  for (; regions.is_finer(level, brick_of(vertex)); --level) vertex = vertex * 2;
  Vec3i brick = brick_of(vertex);
  for (; !regions.has(level, brick); ++level) brick = parent_of(brick);
  return levels[static_cast<size_t>(level)].missing_value(brick) > 0;
}

}  // namespace soapfilm
