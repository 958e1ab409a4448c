// What a coarse brick hands to its eight children.
#pragma once

#include <array>

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

  /// An octant's row: of four vertices along x, from (X, Y, Z) on.
  using Row = std::array<float, half_brick>;
  Row row(int X, int Y, int Z) const { return row_from(own + brick_offset(X, Y, Z)); }
  /// And below them.
  Row row_below(int X, int Y, int Z) const {
    const float* const here = own + brick_offset(X, Y, Z);
    if constexpr (axis == 0) return {X > 0 ? here[-1] : low.at(Y, Z), here[0], here[1], here[2]};
    if constexpr (axis == 1) return row_from(Y > 0 ? here - brick_stride[1] : low.row(Z) + X);
    return row_from(Z > 0 ? here - brick_stride[2] : low.row(Y) + X);
  }

  const float* own;
  LowFace low;

 private:
  static Row row_from(const float* values) { return {values[0], values[1], values[2], values[3]}; }
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
