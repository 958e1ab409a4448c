#include "soapfilm/finish/nearest_sample.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace soapfilm {

namespace {

/// Square of the distance from `place` to the box of the brick.
double to_brick2(Vec3d place, Vec3i brick) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double lo = brick[axis] * double{brick_side}, hi = lo + brick_side;
    const double d = std::max({lo - place[axis], place[axis] - hi, 0.0});
    sum += d * d;
  }
  return sum;
}

/// Visits the bricks at the Chebyshev distance `r` from `center`, in a fixed order.
template <class Visit>
void for_each_of_shell(Vec3i center, int r, Visit&& visit) {
  for (int z = -r; z <= r; ++z)
    for (int y = -r; y <= r; ++y) {
      const bool face = std::abs(z) == r || std::abs(y) == r;
      for (int x = -r; x <= r; x += face || r == 0 ? 1 : 2 * r) visit(center + Vec3i{x, y, z});
    }
}

/// Makes best2 the square of the distance to the brick's nearest sample, if that is smaller, or one of at most enough2.
/// Its samples are sorted along z: from the place's height up and down.
void search(const GridSamples& samples, size_t brick, Vec3d place, double enough2, double& best2) {
  const auto begin = samples.local.begin() + samples.begin[brick],
             end = samples.local.begin() + samples.begin[brick + 1];
  const auto is_below = [](Vec3f sample, double z) { return double{sample.z} < z; };
  auto up = std::lower_bound(begin, end, place.z, is_below), down = up;
  // False where the samples on this side are too far above or below.
  const auto take = [&](Vec3f sample) {
    const Vec3d d = Vec3d(sample) - place;
    if (d.z * d.z >= best2) return false;
    best2 = std::min(best2, dot(d, d));
    return true;
  };
  for (bool go_up = true, go_down = true; (go_up || go_down) && best2 > enough2;) {
    go_up = go_up && up != end && take(*up++);
    go_down = go_down && best2 > enough2 && down != begin && take(*--down);
  }
}

}  // namespace

double distance_to_samples(const GridSamples& samples, Vec3d place, double enough, double limit) {
  const double enough2 = enough * enough;
  double best2 = limit * limit;
  const Vec3i center = brick_around(place);
  for (int r = 0; best2 > enough2; ++r) {
    const double reached = (r - 1) * double{brick_side};  // all bricks of this shell are farther
    if (r > 0 && reached * reached >= best2) break;
    for_each_of_shell(center, r, [&](Vec3i brick) {
      if (best2 <= enough2 || to_brick2(place, brick) >= best2) return;
      const int32_t b = samples.bricks.find(brick);
      if (b < 0) return;
      search(samples, static_cast<size_t>(b), place - Vec3d(brick * brick_side), enough2, best2);
    });
  }
  return std::max(std::sqrt(best2), enough);
}

}  // namespace soapfilm
