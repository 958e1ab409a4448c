#include "soapfilm/adapt/regions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// The spacing of samples that are even over what they span, in voxels of their level, by the box around them: their
/// area is about that of its largest face. Of a few, over a surface through the brick.
double even_spacing(std::span<const Vec3f> places) {
  constexpr size_t few = 4;
  const auto n = static_cast<double>(places.size());
  if (places.size() < few) return brick_side / std::sqrt(n);
  Vec3f lo = places[0], hi = places[0];
  for (const Vec3f p : places)
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], p[axis]);
      hi[axis] = std::max(hi[axis], p[axis]);
    }
  const Vec3d size = Vec3d(hi - lo) * ((n + 1) / (n - 1));  // the box around few is smaller than what they span
  return std::sqrt(std::max({size.x * size.y, size.y * size.z, size.z * size.x}) / n);
}

/// Whether on a quarter of the area in a brick of a level the spacing is at most `most`, in voxels of the placed level,
/// of which the level's are `voxel`. Where it is unknown, as in a tree or where samples are few, they are taken as
/// even.
bool are_within(const LevelSamples& level, size_t brick, double voxel, double most) {
  constexpr double enough_area = 0.25;
  const uint32_t begin = level.samples.begin[brick], end = level.samples.begin[brick + 1];
  const double even = voxel * even_spacing(std::span(level.samples.local).subspan(begin, end - begin));
  double all = 0, within = 0;
  for (uint32_t s = begin; s < end; ++s) {
    const double spacing = level.spacing[s] > 0 ? static_cast<double>(level.spacing[s]) : even;
    all += spacing * spacing;
    if (spacing <= most) within += spacing * spacing;
  }
  return within >= enough_area * all;
}

/// What bricks must have to get finer levels: samples at most so many of the finer voxels apart; whether neighbors
/// without samples get them, too. (Below the placed level these have nothing to gain: their surface is the coarser
/// one's.)
struct Rule {
  double most_apart;
  bool with_unsampled;
};
constexpr Rule above{most_spacing, true}, below{most_spacing_below, false};

/// The bricks of a level, with voxels of this size in those of the placed level, that have finer ones: those that ask
/// for them, and around these others where samples are not much too sparse. False where these are all bricks.
bool find_finer(const LevelSamples& level, double voxel, Rule rule, const Context& context, BrickMask& finer,
                BrickMask& asked) {
  constexpr double much = 1.2;
  const BrickGrid& bricks = level.samples.bricks;
  const double most = rule.most_apart * voxel / 2;
  std::vector<uint8_t> asks(bricks.size()), may(bricks.size());
  parallel_for(context, bricks.size(), 64, [&](size_t b) {
    asks[b] = are_within(level, b, voxel, most);
    may[b] = are_within(level, b, voxel, much * most);
  });
  for (size_t b = 0; b < bricks.size(); ++b) {
    if (asks[b] == 0) continue;
    asked.set(bricks.coord(b));
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i at = bricks.coord(b) + slot_offset(slot);
      const int32_t n = bricks.neighbors(b)[static_cast<size_t>(slot)];
      if (finer.contains(at) && (n < 0 ? rule.with_unsampled : may[static_cast<size_t>(n)] != 0)) finer.set(at);
    }
  }
  for (size_t b = 0; b < bricks.size(); ++b)
    if (!finer.test(bricks.coord(b))) return true;
  return false;
}

/// Neighbors of places with a level have at most the next one.
void balance(std::vector<BrickMask>& finer) {
  for (size_t l = 1; l < finer.size(); ++l)
    finer[l - 1].for_each([&](Vec3i b) {
      for (int slot = 0; slot < 27; ++slot)
        if (const Vec3i n = b + slot_offset(slot); finer[l - 1].contains(n)) finer[l].set(parent_of(n));
    });
}

}  // namespace

BrickMask children_of(const BrickMask& parents, Vec3i bricks) {
  BrickMask children(bricks);
  parents.for_each([&](Vec3i parent) {
    for (int k = 0; k < 8; ++k) children.set(child_of(parent, k));
  });
  return children;
}

Regions::Regions(std::vector<BrickMask> finer, std::vector<BrickMask> asked)
    : finer_(std::move(finer)), asked_(std::move(asked)) {
  balance(asked_);
}

int Regions::level_at(Vec3d place) const {
  Vec3i brick;
  for (int axis = 0; axis < 3; ++axis) brick[axis] = static_cast<int>(std::floor((place[axis] + 0.5) / brick_side));
  int level = 0;
  for (; level < coarsest() && !has(level, brick); ++level) brick = parent_of(brick);
  return level;
}

void Regions::give_back(int level, const std::vector<Vec3i>& bricks) {
  const auto l = static_cast<size_t>(level) - 1;
  for (const Vec3i b : bricks) finer_[l].set(b, false);
  for (size_t k = l; k > 0; --k) {
    std::vector<Vec3i> gone;
    finer_[k - 1].for_each([&](Vec3i b) {
      for (int slot = 0; slot < 27; ++slot) {
        const Vec3i n = b + slot_offset(slot);
        if (!finer_[k - 1].contains(n) || finer_[k].test(parent_of(n))) continue;
        gone.push_back(b);
        return;
      }
    });
    for (const Vec3i b : gone) finer_[k - 1].set(b, false);
  }
}

Regions find_regions(const LevelSamples& samples, const Lattice& lattice, int levels, const Context& context) {
  const auto placed = static_cast<size_t>(lattice.added);
  std::vector<BrickMask> finer(placed), asked(placed);
  LevelSamples level;
  for (size_t l = placed; l > 0; --l) {
    const Vec3i box = lattice.box(static_cast<int>(l)).bricks;
    finer[l - 1] = asked[l - 1] = BrickMask(box);
    if (l < placed) level = on_finer_level(l + 1 == placed ? samples : level, finer[l], box, context);
    find_finer(l == placed ? samples : level, std::ldexp(1.0, static_cast<int>(l) - lattice.added), below, context,
               finer[l - 1], asked[l - 1]);
  }
  for (int l = 1; l <= levels; ++l) {
    const Vec3i box = lattice.box(lattice.added + l).bricks;
    level = on_next_level(l == 1 ? samples : level, box, context);
    BrickMask of_level(box), must(box);
    if (!find_finer(level, std::ldexp(1.0, l), above, context, of_level, must)) break;  // no sample has this level
    finer.push_back(std::move(of_level));
    asked.push_back(std::move(must));
  }
  balance(finer);
  return {std::move(finer), std::move(asked)};
}

}  // namespace soapfilm
