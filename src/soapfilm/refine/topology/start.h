// What the sub-voxel fit starts from: a thresholded indicator, and the band around its surface.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/refine/fit/narrow_band.h"
#include "soapfilm/refine/topology/topology.h"
#include "soapfilm/solve/level.h"
#include "soapfilm/surface/indicator.h"

namespace soapfilm {

struct Start {
  LevelBox box;
  BrickGrid grid;   ///< the bricks near the surface
  GapSides inside;  ///< for all other bricks: whether they are inside
  NarrowBand band;  ///< on that grid
  RowArray phi0;    ///< approximate signed distance to the surface, positive inside, voxels
};

/// Starts from the surface of u > threshold; the band is `reach` voxels wide on either side.
/// `where`: restricts the band to these bricks; the start's are then all of the level's, which must hold those around
/// them.
Start start_from(const Level& level, float threshold, double reach, const Context& context,
                 const BrickMask* where = nullptr);

/// u > threshold on the start's bricks. The start must outlive the result.
SignBits signs_of(const Level& level, float threshold, const Start& start, const Context& context);

/// The binary indicator u > threshold on every second vertex: coarse vertex I lies on vertex 2 I. Of the level's
/// members only box, grid, u and inside are set.
/// `where`: restricts it to these bricks; otherwise all that hold vertices of the level's.
Level every_second_vertex(const Level& fine, float threshold, const Context& context, const BrickMask* where = nullptr);

/// Samples on that grid: only their place in the grid, and their order, changes. `where`: only those in these bricks of
/// it.
GridSamples on_every_second_vertex(const GridSamples& samples, const Context& context,
                                   const BrickMask* where = nullptr);

}  // namespace soapfilm
