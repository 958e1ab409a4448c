// From a fit on every second vertex back to the finer band.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/refine/narrow_band.h"

namespace soapfilm {

/// Distances on the finer band, in its voxels, from those on a coarse one whose vertex I lies on vertex 2 I: twice what
/// cubic interpolation along each axis gives (weights -1/16, 9/16, 9/16, -1/16 halfway between two vertices), at the
/// band's edge linear. `otherwise` where the coarse band has not all corners of a vertex's cell.
RowArray prolong_distance(const NarrowBand& coarse_band, const RowArray& coarse, const NarrowBand& fine_band,
                          const RowArray& otherwise, const Context& context);

}  // namespace soapfilm
