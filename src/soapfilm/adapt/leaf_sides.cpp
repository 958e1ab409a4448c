#include "soapfilm/adapt/leaf_sides.h"

namespace soapfilm {

bool LeafSides::are_alike(int level, Vec3i brick) const {
  const Labels& labels = *levels_[static_cast<size_t>(level)].sides;
  const auto missing = [&](Vec3i b) { return regions_.has(level, b) && labels.grid.find(b) == outside_band; };
  if (!missing(brick)) return false;
  const bool inside = labels.is_inside(outside_band, brick);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3i up = step_above(brick, axis);
    if (!missing(up) || labels.is_inside(outside_band, up) != inside) return false;
  }
  return true;
}

LayerAbove LeafSides::above(int level, Vec3i brick, int axis) const {
  const Vec3i next = step_above(brick, axis);
  const auto [a, b] = across(axis);
  LayerAbove layer;
  const bool beyond = !BrickRange::whole(box(level).bricks).contains(next);
  layer.finer = !beyond && regions_.is_finer(level, next);
  std::array<BrickBits, 4> finer;
  BrickBits other;
  Vec3i base;
  int step = 2;  // half vertices per vertex of `other`
  if (layer.finer) {
    for (int k = 0; k < 4; ++k) {
      Vec3i octant;
      octant[a] = k & 1;
      octant[b] = k >> 1;
      finer[static_cast<size_t>(k)] = of(level - 1, child_of(next, octant));
    }
  } else if (!beyond && regions_.has(level, next)) {
    other = of(level, next);
  } else if (!beyond) {
    other = of(level + 1, parent_of(next));
    base = octant_base(octant_in_parent(next));
    step = 4;
  }
  for (int y = 0; y < 2 * brick_side; ++y)
    for (int x = 0; x < 2 * brick_side; ++x) {
      Vec3i at;
      at[a] = layer.finer ? x % brick_side : x / step;
      at[b] = layer.finer ? y % brick_side : y / step;
      const BrickBits& bits = layer.finer ? finer[static_cast<size_t>(x / brick_side + 2 * (y / brick_side))] : other;
      const Vec3i in = base + at;
      const auto bit = static_cast<uint16_t>(1 << x);
      if (bits.test(in.x, in.y, in.z)) layer.rows[static_cast<size_t>(y)] |= bit;
      if (face_exists(level, brick, axis, {x, y}, layer.finer)) layer.exists[static_cast<size_t>(y)] |= bit;
    }
  return layer;
}

bool LeafSides::face_exists(int level, Vec3i brick, int axis, std::array<int, 2> sub_face, bool finer) const {
  if (!box(level).open) return true;
  const auto [a, b] = across(axis);
  Vec3i v;
  v[axis] = brick_side - 1;
  v[a] = sub_face[0] / 2;
  v[b] = sub_face[1] / 2;
  const Vec3i vertex = brick * brick_side + v;
  if (!finer) return has_face_above(box(level), vertex, axis);
  Vec3i fine = step_above(brick, axis) * (2 * brick_side);
  fine[a] += sub_face[0];
  fine[b] += sub_face[1];
  return box(level).is_free(vertex) && box(level - 1).is_free(fine);
}

}  // namespace soapfilm
