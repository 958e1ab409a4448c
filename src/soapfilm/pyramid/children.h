// What a coarse brick hands to its eight children.
#pragma once

#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// A fine face is a quarter of a coarse one.
inline constexpr float face_share = 0.25f;

/// P_axis of coarse vertex (X, Y, Z) of a brick, where the coordinate along `axis` may be -1: the face below the brick.
struct CoarseFlux {
  CoarseFlux(const Level& coarse, size_t brick, int along)
      : own(coarse.p.brick(brick, along)), low(low_face(coarse, brick, along)), axis(along) {}
  float at(int X, int Y, int Z) const {
    if (axis == 0 && X < 0) return low.at(Y, Z);
    if (axis == 1 && Y < 0) return low.at(X, Z);
    if (axis == 2 && Z < 0) return low.at(X, Y);
    return own[brick_offset(X, Y, Z)];
  }

  const float* own;
  LowFace low;
  int axis;
};

/// Whether u = 1 in a child that is left out of the band.
bool inside_child(const Level& coarse, size_t brick, Vec3i octant);

/// What such a child adds to the fine level's energies.
Outside outside_child(const Level& coarse, size_t brick, Vec3i octant, const SupportField& support);

}  // namespace soapfilm
