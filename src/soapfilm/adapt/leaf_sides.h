// u on leaves of several levels, and what a leaf touches above it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "soapfilm/adapt/leaf_energy.h"
#include "soapfilm/adapt/regions.h"
#include "soapfilm/grid/brick_bits.h"

namespace soapfilm {

/// The two axes across one.
constexpr std::array<int, 2> across(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

/// The next vertex, or brick, along an axis.
constexpr Vec3i step_above(Vec3i v, int axis) {
  ++v[axis];
  return v;
}

/// Whether the face above a vertex has area: not at an open border.
inline bool has_face_above(const LevelBox& box, Vec3i vertex, int axis) {
  return !box.open || (box.is_free(vertex) && box.is_free(step_above(vertex, axis)));
}

/// u in the layer above a brick, of half its width: (2a + i, 2b + j) for the sub-face (i, j) of vertex (a, b).
struct LayerAbove {
  std::array<uint16_t, 2 * brick_side> rows{};
  std::array<uint16_t, 2 * brick_side> exists{};  ///< sub-faces that the problem has
  bool finer = false;

  bool test(int a, int b) const { return rows[static_cast<size_t>(b)] >> a & 1; }
  bool has(int a, int b) const { return exists[static_cast<size_t>(b)] >> a & 1; }
  /// What share of a vertex's face the problem has.
  double share(int a, int b) const {
    return 0.25 * (has(2 * a, 2 * b) + has(2 * a + 1, 2 * b) + has(2 * a, 2 * b + 1) + has(2 * a + 1, 2 * b + 1));
  }
};

/// u of bricks, of the level that their place has.
class LeafSides {
 public:
  LeafSides(const Regions& regions, std::span<const LeafLevel> levels) : regions_(regions), levels_(levels) {}

  BrickBits of(int level, Vec3i brick) const { return levels_[static_cast<size_t>(level)].sides->of(brick); }
  LayerAbove above(int level, Vec3i brick, int axis) const;
  /// Whether a leaf brick and those above it have one value without having labels.
  bool are_alike(int level, Vec3i brick) const;

 private:
  const LevelBox& box(int level) const { return levels_[static_cast<size_t>(level)].flux->box; }
  bool face_exists(int level, Vec3i brick, int axis, std::array<int, 2> sub_face, bool finer) const;

  const Regions& regions_;
  std::span<const LeafLevel> levels_;
};

}  // namespace soapfilm
