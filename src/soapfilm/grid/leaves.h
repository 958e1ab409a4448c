// Leaves of several sizes: the vertices of several levels, each place in at most one of them.
#pragma once

#include <cstdint>
#include <span>

#include "soapfilm/grid/brick_grid.h"

namespace soapfilm {

/// Per level, the finest first, the bricks whose vertices are leaves. Vertex I of level l stands for the finest
/// vertices [2^l I, 2^l (I + 1)), as in a pyramid (grid/lattice.h), and its value is that at their center. Leaves that
/// touch, also by an edge or a corner, differ by at most one level.
using LeafLevels = std::span<const BrickGrid* const>;

/// What is at a vertex of a level.
struct LeafAt {
  enum class Kind : uint8_t { leaf, coarser, finer, none };
  Kind kind = Kind::none;
  int32_t brick = -1;  ///< of the leaf's level
  int offset = 0;      ///< in the brick
};

/// The leaf at a vertex, the one of the next coarser level around it, or whether there are finer ones in its place.
LeafAt leaf_at(LeafLevels levels, int level, Vec3i vertex);

/// Throws ParameterError where leaves of two levels overlap, or touch though they differ by more than a level.
void check_leaves(LeafLevels levels);

/// Center of a level's vertex, in lattice coordinates of the finest level.
inline Vec3d leaf_center(int level, Vec3i vertex) {
  const double size = static_cast<double>(uint64_t{1} << level);
  return (Vec3d(vertex) + Vec3d{0.5, 0.5, 0.5}) * size - Vec3d{0.5, 0.5, 0.5};
}

}  // namespace soapfilm
