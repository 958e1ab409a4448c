// The smooth surface defined by the values on a grid, of which marching cubes draws a flat approximation.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
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

  /// `value`: voxels. Both must outlive it. On ranks, each of which asks for a part of the surface, parts are computed
  /// when they are needed.
  SmoothField(const BrickGrid& grid, const Field<float>& value, const Context& context);

  /// At a lattice point; none unless the 32 vertices that it depends on are in the grid's bricks.
  std::optional<Jet> at(Vec3d point) const;

  /// The point of the surface near `point`, by Newton steps along the gradient; none where the distance is unknown or
  /// flat (slope under 0.3), or no surface lies within `reach` voxels.
  std::optional<Vec3d> project(Vec3d point, double reach) const;

 private:
  /// Values around a cell, 4 along each axis.
  using Around = std::array<float, 64>;
  bool gather(Vec3i cell, Around& around) const;
  /// Computes the values of bricks [begin, end).
  void smooth(size_t begin, size_t end) const;
  /// Where parts are computed when needed: those around a cell are there from now on.
  void need_around(const BrickGrid::Neighbors& neighbors, Vec3i first) const;

  const BrickGrid& grid_;
  const Field<float>& rough_;
  mutable Field<float> value_;
  struct Part {
    std::once_flag once;
    std::atomic<bool> is_there{false};  ///< faster to ask than `once`
  };
  mutable std::unique_ptr<Part[]> parts_;  ///< null: all are there
};

}  // namespace soapfilm
