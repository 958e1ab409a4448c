// From a fit on the half-resolution grid back to the finer band.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/refine/fit/narrow_band.h"

namespace soapfilm {

/// Distances on the finer band, in its voxels, from those on a coarse one whose vertex I lies on vertex 2 I: twice the
/// result of cubic interpolation along each axis (weights -1/16, 9/16, 9/16, -1/16 halfway between two vertices),
/// linear at the band boundary. `otherwise` where a corner of a vertex's cell is not in the coarse band.
RowArray prolong_distance(const NarrowBand& coarse_band, const RowArray& coarse, const NarrowBand& fine_band,
                          const RowArray& otherwise, const Context& context);

}  // namespace soapfilm
