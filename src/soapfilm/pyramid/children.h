// The data that the eight children of a coarse brick get from it.
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
  /// Of the vertex below (X, Y, Z) along the axis.
  float below(int X, int Y, int Z) const { return at(X - (axis == 0), Y - (axis == 1), Z - (axis == 2)); }

  /// Of four vertices along x: an octant's row.
  using Row = std::array<float, half_brick>;
  /// visit(y, z, row, the row below it along the axis) for an octant's rows; y and z from its first vertex on.
  template <class Visit>
  void for_each_row(Vec3i octant, Visit&& visit) const {
    const Vec3i base = octant_base(octant);
    for (int z = 0; z < half_brick; ++z)
      for (int y = 0; y < half_brick; ++y) {
        const Vec3i first = base + Vec3i{0, y, z};
        visit(y, z, row_from(own + brick_offset(first.x, first.y, first.z)), row_below(first.x, first.y, first.z));
      }
  }

  const float* own;
  LowFace low;

 private:
  Row row_below(int X, int Y, int Z) const {
    const float* const here = own + brick_offset(X, Y, Z);
    if constexpr (axis == 0) return {X > 0 ? here[-1] : low.at(Y, Z), here[0], here[1], here[2]};
    if constexpr (axis == 1) return row_from(Y > 0 ? here - brick_stride[1] : low.row(Z) + X);
    return row_from(Z > 0 ? here - brick_stride[2] : low.row(Y) + X);
  }
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

/// The contribution of such a child to the fine level's energies.
OutsideTerms outside_child(const Level& coarse, size_t brick, Vec3i octant, const SupportField& support);

}  // namespace soapfilm
