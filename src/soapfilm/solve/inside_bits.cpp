#include "soapfilm/solve/inside_bits.h"

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// For a brick outside the band.
const BrickBits& constant_bits(const Level& level, float threshold, int32_t n, Vec3i brick) {
  static const BrickBits none, all = BrickBits::full();
  return level.missing_u(n, brick) > threshold ? all : none;
}

}  // namespace

BrickBits inside_of(const Level& level, float threshold, int32_t n, Vec3i brick) {
  return n >= 0 ? BrickBits::above(level.u.brick(static_cast<size_t>(n)), threshold)
                : constant_bits(level, threshold, n, brick);
}

InsideBits::InsideBits(const Level& level, float threshold, const Context& context)
    : level_(level), threshold_(threshold), bits_(level.grid.size()) {
  parallel_for(context, bits_.size(), 64, [&](size_t b) { bits_[b] = BrickBits::above(level.u.brick(b), threshold); });
}

const BrickBits& InsideBits::of(int32_t n, Vec3i brick) const {
  return n >= 0 ? bits_[static_cast<size_t>(n)] : constant_bits(level_, threshold_, n, brick);
}

BrickBits InsideBits::continued(int32_t n, Vec3i brick) const {
  const LevelBox& box = level_.box;
  if (!box.open || free_range(box, brick).whole()) return of(n, brick);
  // Where a brick has no free vertices along an axis, those next to all of its vertices are in the same layer.
  const Vec3i first = brick * brick_side, last = first + Vec3i{brick_side - 1, brick_side - 1, brick_side - 1};
  Vec3i from = brick;
  for (int axis = 0; axis < 3; ++axis)
    if (last[axis] < box.free_lo[axis] || first[axis] > box.free_hi[axis])
      from[axis] = brick_of(nearest_free(box, first))[axis];
  const BrickBits& bits = from == brick ? of(n, brick) : of(level_.grid.find(from), from);
  BrickBits found;
  for (int i = 0; i < brick_volume; ++i) {
    const Vec3i v = nearest_free(box, first + vertex_in_brick(i)) - from * brick_side;
    if (bits.test(v.x, v.y, v.z)) found.set(i);
  }
  return found;
}

BrickBits InsideBits::interface(size_t b) const {
  const BrickBits& own = bits_[b];
  const bool ends = level_.box.open && at_border(level_.box, level_.grid.coord(b));
  BrickBits found;
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      const int slot = step > 0 ? slot_down[axis] : slot_up[axis];  // whose bits move into this brick
      const BrickBits& beside =
          of(level_.grid.neighbors(b)[static_cast<size_t>(slot)], level_.grid.coord(b) + slot_offset(slot));
      const BrickBits next = moved(own, axis, step) | carried(beside, axis, step);
      found |= ends ? (own ^ next) & joined_to(b, axis, -step) : own ^ next;
    }
  return found;
}

BrickBits InsideBits::joined_to(size_t b, int axis, int step) const {
  if (!level_.box.open || !at_border(level_.box, level_.grid.coord(b))) return BrickBits::full();
  BrickBits found;
  for (int i = 0; i < brick_volume; ++i) {
    const Vec3i v = level_.grid.first_vertex(b) + vertex_in_brick(i);
    Vec3i next = v;
    next[axis] += step;
    if (level_.box.is_free(v) && level_.box.is_free(next)) found.set(i);
  }
  return found;
}

std::vector<BrickBits> InsideBits::interfaces(const Context& context) const {
  std::vector<BrickBits> found(bits_.size());
  parallel_for(context, found.size(), 64, [&](size_t b) { found[b] = interface(b); });
  return found;
}

}  // namespace soapfilm
