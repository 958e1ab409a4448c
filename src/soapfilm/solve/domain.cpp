#include "soapfilm/solve/domain.h"

namespace soapfilm {

FreeRange free_range(const LevelBox& box, Vec3i brick) {
  FreeRange range;
  for (int axis = 0; axis < 3; ++axis) {
    range.lo[axis] = std::clamp(box.free_lo[axis] - brick_side * brick[axis], 0, brick_side);
    range.hi[axis] = std::clamp(box.free_hi[axis] + 1 - brick_side * brick[axis], 0, brick_side);
  }
  return range;
}

bool at_border(const LevelBox& box, Vec3i brick) {
  const Vec3i first = brick * brick_side;
  return !box.is_free(first - Vec3i{1, 1, 1}) || !box.is_free(first + Vec3i{brick_side, brick_side, brick_side});
}

}  // namespace soapfilm
