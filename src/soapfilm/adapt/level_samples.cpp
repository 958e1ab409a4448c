#include "soapfilm/adapt/level_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace soapfilm {

namespace {

/// Along one axis: a brick and the position in it.
struct Place {
  int brick;
  float local;
};

/// In double: a position just below a brick's end must not round into the next one.
Place place_at(double vertex) {
  const auto brick = static_cast<int>(std::floor(vertex / brick_side));
  const float last = std::nextafter(static_cast<float>(brick_side), 0.0f);
  return {brick, std::min(static_cast<float>(vertex - static_cast<double>(brick) * brick_side), last)};
}

template <class T>
std::vector<T> taken_of(const std::vector<T>& column, const std::vector<uint32_t>& taken) {
  std::vector<T> out;
  if (column.empty()) return out;
  out.reserve(taken.size());
  for (const uint32_t s : taken) out.push_back(column[s]);
  return out;
}

/// Those in the bricks for which takes(brick), moved along each axis: vertex x of their lattice is at_vertex(x) of the
/// other level's.
template <class Takes, class AtVertex>
LevelSamples moved(const LevelSamples& from, Vec3i bricks, const Context& context, Takes&& takes,
                   AtVertex&& at_vertex) {
  const GridSamples& samples = from.samples;
  std::vector<uint32_t> kept;
  std::vector<Vec3i> brick;
  std::vector<Vec3f> local;
  BrickMask mask(bricks);
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    const Vec3i in = samples.bricks.coord(b);
    if (!takes(in)) continue;
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      kept.push_back(s);
      Vec3i& to = brick.emplace_back();
      Vec3f& at = local.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        const Place place = place_at(
            at_vertex(static_cast<double>(in[axis]) * brick_side + static_cast<double>(samples.local[s][axis])));
        to[axis] = place.brick;
        at[axis] = place.local;
      }
      mask.set(to);
    }
  }
  BrickGrid grid(mask, context);
  // By brick, in the order of the level that they come from within one.
  std::vector<uint32_t> first(grid.size() + 1), of(kept.size());
  for (size_t k = 0; k < kept.size(); ++k) {
    of[k] = static_cast<uint32_t>(grid.find(brick[k]));
    ++first[of[k] + 1];
  }
  for (size_t b = 0; b < grid.size(); ++b) first[b + 1] += first[b];
  std::vector<uint32_t> next(first.begin(), first.end() - 1), taken(kept.size());
  std::vector<Vec3f> places(kept.size());
  for (size_t k = 0; k < kept.size(); ++k) {
    const uint32_t to = next[of[k]]++;
    taken[to] = kept[k];
    places[to] = local[k];
  }
  LevelSamples other;
  other.samples = samples.select(std::move(grid), std::move(first), taken, context);
  other.samples.local = std::move(places);
  other.views = taken_of(from.views, taken);
  other.spacing = taken_of(from.spacing, taken);
  return other;
}

}  // namespace

LevelSamples select(const LevelSamples& level, const std::function<bool(size_t, uint32_t)>& keep,
                    const Context& context) {
  const GridSamples& samples = level.samples;
  std::vector<uint32_t> first{0}, taken;
  BrickMask bricks(samples.bricks.bricks());
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      if (keep(b, s)) taken.push_back(s);
    if (taken.size() == first.back()) continue;
    bricks.set(samples.bricks.coord(b));
    first.push_back(static_cast<uint32_t>(taken.size()));
  }
  LevelSamples chosen;
  chosen.samples = samples.select(BrickGrid(bricks, context), std::move(first), taken, context);
  chosen.views = taken_of(level.views, taken);
  chosen.spacing = taken_of(level.spacing, taken);
  return chosen;
}

LevelSamples on_next_level(const LevelSamples& fine, Vec3i coarse_bricks, const Context& context) {
  return moved(
      fine, coarse_bricks, context, [](Vec3i) { return true; }, [](double vertex) { return 0.5 * (vertex - 0.5); });
}

LevelSamples on_finer_level(const LevelSamples& coarse, const BrickMask& in, Vec3i fine_bricks,
                            const Context& context) {
  return moved(
      coarse, fine_bricks, context, [&](Vec3i brick) { return in.test(brick); },
      [](double vertex) { return 2 * vertex + 0.5; });
}

}  // namespace soapfilm
