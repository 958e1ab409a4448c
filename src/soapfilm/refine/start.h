// What the sub-voxel fit starts from: a thresholded indicator, and the band around its surface.
#pragma once

#include "soapfilm/core/parallel.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/refine/indicator.h"
#include "soapfilm/refine/narrow_band.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

struct Start {
  BrickGrid grid;    ///< the bricks near the surface
  BrickMask inside;  ///< for the others: are they inside
  NarrowBand band;   ///< on that grid
  RowArray phi0;     ///< about the signed distance to the surface, positive inside, voxels
};

/// Of the surface of u > threshold; the band is `reach` voxels wide on either side.
Start start_from(const Level& level, float threshold, double reach, const Parallel& parallel);

/// The binary indicator u > threshold on every second vertex: coarse vertex I lies on vertex 2 I. Of the level's fields
/// the box, the grid, u and what is inside are there.
Level every_second_vertex(const Level& fine, float threshold, const Parallel& parallel);

/// Samples on that grid: nothing but their place in the grid changes, and their order.
GridSamples on_every_second_vertex(const GridSamples& samples, const Parallel& parallel);

}  // namespace soapfilm
