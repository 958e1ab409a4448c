#include "soapfilm/adapt/leaf_labels.h"

#include <array>

#include "soapfilm/adapt/surroundings.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/trilinear.h"

namespace soapfilm {

namespace {

/// Where a level or finer ones have the places.
Labels in_places(const Regions& regions, int number, const Level& level, const Labels* finer, float threshold,
                 const Context& context) {
  Labels labels{static_cast<const Domain&>(level), {}};
  labels.bits.resize(level.grid.size());
  parallel_for(context, labels.bits.size(), 64, [&](size_t b) {
    const Vec3i at = level.grid.coord(b);
    labels.bits[b] = finer && regions.is_finer(number, at) ? most_of_children(*finer, at)
                                                           : BrickBits::above(level.u.brick(b), threshold);
  });
  return labels;
}

float value_at(const DistanceField& field, Vec3i v) {
  const int32_t n = field.grid.find(brick_of(v));
  return n >= 0 ? field.value.brick(static_cast<size_t>(n))[brick_offset(v.x & 7, v.y & 7, v.z & 7)]
                : field.missing_value(brick_of(v));
}

/// The distance from a level's surface, in its voxels, at a vertex of the next finer level; as far as it is known.
float distance_at_finer(const DistanceField& coarse, Vec3i fine_vertex) {
  // Fine vertex v lies at (v - 1/2) / 2 on the coarser level: a quarter below or above one of its vertices.
  Vec3i first;
  Vec3f in_cell;
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = (fine_vertex[axis] - 1) >> 1;
    in_cell[axis] = fine_vertex[axis] % 2 == 0 ? 0.75f : 0.25f;
  }
  std::array<float, 8> corners;
  for (int k = 0; k < 8; ++k) corners[static_cast<size_t>(k)] = value_at(coarse, first + octant_of(k));
  return trilinear(corners, in_cell).value;
}

/// On which side of a coarser level's surface the vertices of a brick are.
BrickBits sides_of(const DistanceField& coarser, Vec3i brick) {
  BrickBits bits;
  if (coarser.grid.find(parent_of(brick)) < 0)
    return coarser.missing_value(parent_of(brick)) > 0 ? BrickBits::full() : bits;
  for (int i = 0; i < brick_volume; ++i)
    if (distance_at_finer(coarser, brick * brick_side + vertex_in_brick(i)) > 0) bits.set(i);
  return bits;
}

}  // namespace

std::vector<Labels> labels_of_leaves(const Regions& regions, std::span<const Level> levels, float threshold,
                                     const Context& context) {
  std::vector<Labels> labels;
  for (size_t l = 0; l < levels.size(); ++l)
    labels.push_back(
        in_places(regions, static_cast<int>(l), levels[l], l > 0 ? &labels[l - 1] : nullptr, threshold, context));
  return labels;
}

Labels continued_beyond(const Labels& own, const DistanceField& coarser, const Context& context) {
  const auto has_values = [&](Vec3i b) {
    return own.covers(b) ? own.grid.find(b) >= 0 : coarser.grid.find(parent_of(b)) >= 0;
  };
  const auto side = [&](Vec3i b) { return own.covers(b) ? own.of(b) : sides_of(coarser, b); };
  BrickMask bricks(own.box.bricks);
  for (size_t b = 0; b < own.grid.size(); ++b)
    if (own.covers(own.grid.coord(b))) bricks.set(own.grid.coord(b));
  for (size_t c = 0; c < coarser.grid.size(); ++c)
    for (int k = 0; k < 8; ++k)
      if (const Vec3i child = child_of(coarser.grid.coord(c), k); bricks.contains(child) && !own.covers(child))
        bricks.set(child);
  // Where the places end both sides may be without values, and differ.
  own.places->for_each([&](Vec3i b) {
    for (int axis = 0; axis < 3; ++axis)
      for (const int slot : {slot_down[axis], slot_up[axis]}) {
        const Vec3i beside = b + slot_offset(slot);
        if (own.covers(beside) || !bricks.contains(beside) || has_values(b) || has_values(beside)) continue;
        if (side(b) == side(beside)) continue;
        bricks.set(b);
        bricks.set(beside);
      }
  });
  Labels all;
  all.box = own.box;
  all.grid = BrickGrid(bricks, context);
  all.inside = GapSides(all.grid, bricks_with_free(all.box), [&](Vec3i b) { return side(b).test(0, 0, 0); });
  all.bits.resize(all.grid.size());
  parallel_for(context, all.grid.size(), 64, [&](size_t b) { all.bits[b] = side(all.grid.coord(b)); });
  return all;
}

}  // namespace soapfilm
