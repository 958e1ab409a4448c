// The smooth surface defined by the values on a grid, of which marching cubes draws a flat approximation.
#pragma once

#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/trilinear.h"

namespace soapfilm {

/// A signed distance on the grid's vertices, interpolated with continuous slopes. Values that were fitted to samples by
/// trilinear interpolation lie on the concave side of a curved surface, so that its chords are on both sides of the
/// samples; a fraction of their Laplacian is added to undo that. Between vertices: trilinear interpolation minus sum_k
/// t_k (1 - t_k) / 2 times that of the second difference along axis k, which along grid lines is the cubic of Catmull
/// and Rom (1974). O(h^3).
class SmoothField {
 public:
  using Jet = FieldJet<double>;

  /// `value`: voxels. `grid` must outlive it.
  SmoothField(const BrickGrid& grid, const Field<float>& value, const Context& context);

  /// At a lattice point; none unless the 32 vertices that it depends on are in the grid's bricks.
  std::optional<Jet> at(Vec3d point) const;

  /// The point of the surface near `point`, by Newton steps along the gradient; none where the distance is unknown or
  /// flat (slope under 0.3), or no surface lies within `reach` voxels.
  std::optional<Vec3d> project(Vec3d point, double reach) const;

 private:
  const BrickGrid& grid_;
  Field<float> value_;
};

}  // namespace soapfilm
