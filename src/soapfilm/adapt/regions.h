// Which level each place of the lattice has: as fine as its samples ask for.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "soapfilm/adapt/level_samples.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// The rule: a place has a level where neighboring samples are at most this many of its voxels apart; a level below the
/// placed one where each voxel has a sample, as the default voxel has on average.
inline constexpr double most_spacing = 2.0, most_spacing_below = 1.0;

/// A level per place. Places that touch, also by an edge or a corner, differ by at most one level.
class Regions {
 public:
  /// All places have level 0.
  Regions() = default;
  /// `finer[k]`: the bricks of level k + 1 whose places have level k or a finer one, balanced; of these, `asked[k]`:
  /// those whose samples ask for it.
  Regions(std::vector<BrickMask> finer, std::vector<BrickMask> asked);

  int coarsest() const { return static_cast<int>(finer_.size()); }
  /// Whether level - 1 or finer levels have the places of a brick of this level.
  bool is_finer(int level, Vec3i brick) const {
    if (level == 0) return false;
    const BrickMask& mask = finer_[static_cast<size_t>(level) - 1];
    return mask.contains(brick) && mask.test(brick);
  }
  /// Whether the places of a brick of this level have it.
  bool has(int level, Vec3i brick) const {
    return !is_finer(level, brick) && (level == coarsest() || is_finer(level + 1, parent_of(brick)));
  }
  /// The level that a place has, in lattice coordinates of the finest level, whose vertex I has what lies from I - 1/2
  /// to I + 1/2.
  int level_at(Vec3d place) const;
  /// The same places without the finest levels: those that have one have this level, which becomes level 0.
  Regions from(int level) const {
    const auto rest = [level](const std::vector<BrickMask>& masks) {
      return std::vector<BrickMask>(masks.begin() + level, masks.end());
    };
    return {rest(finer_), rest(asked_)};
  }
  /// The same places, those of coarser levels with this one.
  Regions up_to(int level) const {
    const auto first = [level](const std::vector<BrickMask>& masks) {
      return std::vector<BrickMask>(masks.begin(), masks.begin() + static_cast<std::ptrdiff_t>(level));
    };
    return {first(finer_), first(asked_)};
  }
  /// The bricks of this level whose places have finer ones, level >= 1.
  const BrickMask& finer(int level) const { return finer_[static_cast<size_t>(level) - 1]; }
  /// Those of them that must, by their samples or by the balance.
  const BrickMask& asked(int level) const { return asked_[static_cast<size_t>(level) - 1]; }

  /// Gives bricks of a level that are not asked for back to it, and what the balance then takes from finer levels.
  void give_back(int level, const std::vector<Vec3i>& bricks);

 private:
  std::vector<BrickMask> finer_, asked_;
};

/// The eight children of each brick, in a box of so many bricks.
BrickMask children_of(const BrickMask& parents, Vec3i bricks);

/// By the samples' spacing: level l - 1 has the bricks of level l where on a quarter of the area the spacing is at most
/// most_spacing (most_spacing_below) voxels of level l - 1; then of their neighbors those without samples (not below
/// the placed level), and those where it is at most 1.2 times as large; then what the balance asks for. `samples` are
/// on the placed level, which is level lattice.added; `levels` at most are coarser.
Regions find_regions(const LevelSamples& samples, const Lattice& lattice, int levels, const Context& context);

}  // namespace soapfilm
