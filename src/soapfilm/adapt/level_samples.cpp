#include "soapfilm/adapt/level_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace soapfilm {

namespace {

/// Along one axis, from a fine brick and the position in it.
struct CoarsePlace {
  int brick;
  float local;
};

CoarsePlace coarse_place(int brick, float local) {
  // In double: a position just below a brick's end must not round into the next one.
  const double place = 0.5 * (static_cast<double>(brick) * brick_side + static_cast<double>(local) - 0.5);
  const auto coarse = static_cast<int>(std::floor(place / brick_side));
  const float last = std::nextafter(static_cast<float>(brick_side), 0.0f);
  return {coarse, std::min(static_cast<float>(place - static_cast<double>(coarse) * brick_side), last)};
}

template <class T>
std::vector<T> taken_of(const std::vector<T>& column, const std::vector<uint32_t>& taken) {
  std::vector<T> out;
  if (column.empty()) return out;
  out.reserve(taken.size());
  for (const uint32_t s : taken) out.push_back(column[s]);
  return out;
}

}  // namespace

LevelSamples on_next_level(const LevelSamples& fine, Vec3i coarse_bricks, const Context& context) {
  const GridSamples& samples = fine.samples;
  std::vector<Vec3i> brick(samples.size());
  std::vector<Vec3f> local(samples.size());
  BrickMask mask(coarse_bricks);
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    const Vec3i at = samples.bricks.coord(b);
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      for (int axis = 0; axis < 3; ++axis) {
        const CoarsePlace place = coarse_place(at[axis], samples.local[s][axis]);
        brick[s][axis] = place.brick;
        local[s][axis] = place.local;
      }
      mask.set(brick[s]);
    }
  }
  BrickGrid grid(mask, context);
  // By brick, in the order of the finer level within one.
  std::vector<uint32_t> first(grid.size() + 1), of(samples.size());
  for (size_t s = 0; s < samples.size(); ++s) {
    of[s] = static_cast<uint32_t>(grid.find(brick[s]));
    ++first[of[s] + 1];
  }
  for (size_t b = 0; b < grid.size(); ++b) first[b + 1] += first[b];
  std::vector<uint32_t> next(first.begin(), first.end() - 1), taken(samples.size());
  for (size_t s = 0; s < samples.size(); ++s) taken[next[of[s]]++] = static_cast<uint32_t>(s);

  LevelSamples coarse;
  coarse.samples = samples.select(std::move(grid), std::move(first), taken, context);
  for (size_t k = 0; k < taken.size(); ++k) coarse.samples.local[k] = local[taken[k]];
  coarse.views = taken_of(fine.views, taken);
  coarse.spacing = taken_of(fine.spacing, taken);
  return coarse;
}

}  // namespace soapfilm
