#include "soapfilm/solve/inside_bits.h"

namespace soapfilm {

InsideBits::InsideBits(const Level& level, float threshold, const Parallel& parallel)
    : level_(level), threshold_(threshold), bits_(level.grid.size()) {
  parallel.for_each(bits_.size(), 64, [&](size_t b) { bits_[b] = BrickBits::above(level.u.brick(b), threshold); });
}

const BrickBits& InsideBits::of(int32_t n, Vec3i brick) const {
  static const BrickBits none, all = BrickBits::full();
  if (n >= 0) return bits_[static_cast<size_t>(n)];
  return level_.missing_u(n, brick) > threshold_ ? all : none;
}

BrickBits InsideBits::interface(size_t b) const {
  const BrickBits& own = bits_[b];
  BrickBits found;
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      const int slot = step > 0 ? slot_down[axis] : slot_up[axis];  // whose bits move into this brick
      const BrickBits& beside =
          of(level_.grid.neighbors(b)[static_cast<size_t>(slot)], level_.grid.coord(b) + slot_offset(slot));
      const BrickBits next = moved(own, axis, step) | carried(beside, axis, step);
      found |= own ^ next;
    }
  return found;
}

}  // namespace soapfilm
