// What a coarse brick hands to its eight children.
#pragma once

#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// A fine face is a quarter of a coarse one.
inline constexpr float face_share = 0.25f;

/// P_axis of coarse vertex (X, Y, Z) of a brick, where the coordinate along `axis` may be -1: the face below the brick.
template <int axis>
struct CoarseFlux {
  CoarseFlux(const Level& coarse, size_t brick)
      : own(coarse.p.brick(brick, axis)), low(low_face(coarse, brick, axis)) {}
  float at(int X, int Y, int Z) const {
    if (axis == 0 && X < 0) return low.at(Y, Z);
    if (axis == 1 && Y < 0) return low.at(X, Z);
    if (axis == 2 && Z < 0) return low.at(X, Y);
    return own[brick_offset(X, Y, Z)];
  }
  /// Of the vertex below that one along the axis.
  float below(int X, int Y, int Z) const { return at(X - (axis == 0), Y - (axis == 1), Z - (axis == 2)); }

  const float* own;
  LowFace low;
};

/// visit(CoarseFlux) along x, y and z.
template <class Visit>
void for_each_flux(const Level& coarse, size_t brick, Visit&& visit) {
  visit(CoarseFlux<0>(coarse, brick));
  visit(CoarseFlux<1>(coarse, brick));
  visit(CoarseFlux<2>(coarse, brick));
}

/// Whether u = 1 in a child that is left out of the band.
bool inside_child(const Level& coarse, size_t brick, Vec3i octant);

/// What such a child adds to the fine level's energies.
Outside outside_child(const Level& coarse, size_t brick, Vec3i octant, const SupportField& support);

}  // namespace soapfilm
