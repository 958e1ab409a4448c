// What the sub-voxel fit starts from: labels, and the band around its surface.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/refine/fit/narrow_band.h"
#include "soapfilm/refine/topology/topology.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/surface/indicator.h"

namespace soapfilm {

struct Start {
  LevelBox box;
  BrickGrid grid;   ///< the bricks near the surface
  GapSides inside;  ///< for all other bricks: whether they are inside
  NarrowBand band;  ///< on that grid
  RowArray phi0;    ///< approximate signed distance to the surface, positive inside, voxels
};

/// The band is `reach` voxels wide on either side.
/// `where`: restricts it to these bricks; the start's are then all of the labels', which must hold those around them.
Start start_from(const Labels& labels, double reach, const Context& context, const BrickMask* where = nullptr);

/// The labels on the start's bricks. The start must outlive the result.
SignBits signs_of(const Labels& labels, const Start& start, const Context& context);

/// The labels of every second vertex: coarse vertex I lies on vertex 2 I.
/// `where`: restricts them to these bricks; otherwise all that hold vertices of the fine ones'.
Labels every_second_vertex(const Labels& fine, const Context& context, const BrickMask* where = nullptr);

/// Samples on that grid: only their place in the grid, and their order, changes. `where`: only those in these bricks of
/// it.
GridSamples on_every_second_vertex(const GridSamples& samples, const Context& context,
                                   const BrickMask* where = nullptr);

}  // namespace soapfilm
