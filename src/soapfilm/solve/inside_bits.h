// Where a level's u is above a threshold, one bit per vertex.
#pragma once

#include <vector>

#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// u > threshold in one brick of the domain; `n` is the result of BrickGrid::find.
BrickBits inside_of(const Level& level, float threshold, int32_t n, Vec3i brick);

/// u > threshold in the level's bricks and in the constant ones of its domain. The level must outlive it.
class InsideBits {
 public:
  InsideBits(const Level& level, float threshold, const Context& context);

  /// As inside_of().
  const BrickBits& of(int32_t n, Vec3i brick) const;
  /// The same, but beyond an open border as at the nearest vertex in front of it.
  BrickBits continued(int32_t n, Vec3i brick) const;
  /// The vertices of brick b of the level that have one of their six neighbors on the other side; none across an open
  /// border.
  BrickBits interface(size_t b) const;
  std::vector<BrickBits> interfaces(const Context& context) const;  ///< of all bricks
  /// Vertices of brick b whose face to the neighbor along an axis, up (step 1) or down (-1), belongs to the problem:
  /// all but those at an open border.
  BrickBits joined_to(size_t b, int axis, int step) const;

 private:
  const Level& level_;
  float threshold_;
  std::vector<BrickBits> bits_;
};

}  // namespace soapfilm
