// A function whose level set is the surface: values on the bricks around it, and a side elsewhere. There are two kinds.
#pragma once

#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/gaps.h"

namespace soapfilm {

struct SurfaceField {
  BrickGrid grid;
  Field<float> value;
  GapSides inside;  ///< for the gaps of the grid; false beyond the domain
};

/// About 1 inside and 0 outside: the surface is a level set between (section 4.4). In an open box only the surface in
/// front of its border counts.
struct IndicatorField : SurfaceField {
  /// Of a brick that the grid lacks.
  float missing_value(Vec3i brick) const { return inside.test(grid, brick) ? 1.0f : 0.0f; }
};

/// About the signed distance from the surface, voxels, positive inside: the surface is the level set 0. Farther away
/// than `far` only the sign is known.
struct DistanceField : SurfaceField {
  static constexpr float far = 3;
  /// Of a brick that the grid lacks.
  float missing_value(Vec3i brick) const { return inside.test(grid, brick) ? far : -far; }
};

}  // namespace soapfilm
