// Section 4.4: from the relaxed u to the smooth field whose level set is the surface.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/gaps.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Values on the bricks around the surface; elsewhere the constant 0 or 1 given by `inside`. In an open box only the
/// surface in front of its border counts.
struct SurfaceField {
  BrickGrid grid;
  Field<float> value;
  GapSides inside;

  /// The value of a brick that the grid lacks; 0 beyond the domain.
  float missing_value(Vec3i brick) const { return inside.test(grid, brick) ? 1.0f : 0.0f; }
};

/// The binary indicator, 1 where u > threshold, smoothed with the filter of section 4.1; values in [0, 1]. Its bricks
/// are those within 4 vertices of the interface. Beyond an open border it goes on as it is in front of it. `threshold`
/// is the paper's mu, in (0, 1).
SurfaceField smoothed_indicator(const Level& level, float threshold, const Context& context);
/// The same on given bricks, of a level whose grid may be a part of its band: right where it holds the 26 around.
SurfaceField smoothed_indicator(const Level& level, float threshold, BrickGrid bricks, const Context& context);

/// The same without smoothing: 0 and 1 on the same bricks.
SurfaceField binary_indicator(const Level& level, float threshold, const Context& context);

/// The mean of the field at the samples (trilinear interpolation, equal weights): the paper's isovalue.
double mean_at_samples(const SurfaceField& field, const GridSamples& samples, const Context& context);

/// Vertices of the whole domain with u > threshold.
size_t count_inside(const Level& level, float threshold, const Context& context);

}  // namespace soapfilm
