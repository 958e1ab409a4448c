// Keeps the topology of the segmentation while the surface moves, except for components that the fit shrinks to
// nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/gaps.h"
#include "soapfilm/refine/fit/narrow_band.h"

namespace soapfilm {

/// One bit per vertex of a grid of bricks, constant in bricks that are not in the grid.
class SignBits {
 public:
  SignBits(const BrickGrid& grid, const GapSides& inside) : grid_(&grid), inside_(&inside), rows_(grid.size() * 64) {}

  uint8_t& row(size_t brick, int y, int z) { return rows_[brick * 64 + static_cast<size_t>(y + 8 * z)]; }
  uint8_t row(size_t brick, int y, int z) const { return rows_[brick * 64 + static_cast<size_t>(y + 8 * z)]; }
  /// All rows of a brick.
  void set(size_t brick, const BrickBits& bits);
  BrickBits bits(size_t brick) const;
  bool test(size_t brick, int x, int y, int z) const { return row(brick, y, z) >> x & 1; }
  bool test(Vec3i vertex) const;
  void flip(size_t brick, int x, int y, int z) { row(brick, y, z) ^= static_cast<uint8_t>(1 << x); }
  size_t count() const;  ///< vertices inside
  /// Bits by (dx + 1) + 3 (dy + 1) + 9 (dz + 1).
  uint32_t neighborhood(size_t brick, int x, int y, int z) const;

 private:
  const BrickGrid* grid_;
  const GapSides* inside_;
  std::vector<uint8_t> rows_;
};

struct FlipCount {
  size_t wanted = 0;
  size_t refused = 0;   ///< vertices that would have changed the topology
  size_t vanished = 0;  ///< vertices that were a component or a cavity of their own, and have changed
};

inline constexpr float held_distance = 0.05f;  ///< voxels, of vertices whose label must not follow

/// Changes, one after the other in a fixed order, the labels of the band's vertices that differ from the sign of phi,
/// each only while it is simple; where a change is refused, phi is set to `held` voxels on the old side. Afterwards phi
/// > 0 exactly where the bits are set. Components and cavities that had at most `speck` vertices on entry are removed
/// when phi wants their last vertex on the other side: only the topology kept them. Larger ones stay, and so does the
/// last component of all.
FlipCount follow(RowArray& phi, const NarrowBand& band, SignBits& signs, float held, size_t speck);

}  // namespace soapfilm
