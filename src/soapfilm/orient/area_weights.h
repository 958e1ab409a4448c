// The area that each sample represents: voxel size and sample weights follow from it.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/orient/sample_cells.h"

namespace soapfilm {

/// Computes LocalSurface::coverage from its columns, whose samples are those of `order`.
AreaCoverage cover_area(const LocalSurface& surface, const SampleOrder& order);

/// A weight for each sample, 1 on average: the area that it represents over the mean one, so that equal areas have
/// equal weight however many samples they have. Within a factor of 1.5 it is 1 (measured areas of even samples scatter
/// by less); beyond that it changes continuously, up to `most` >= 1. Samples without a plane have weight 1, those on
/// edges and rods up to 16. So do, up to `most_alone`, samples around which no surface shows: outliers, or parts that
/// are sampled too thinly, such as far or thin ones.
std::vector<float> weigh_by_area(const LocalSurface& surface, double most, double most_alone, const Context& context);

}  // namespace soapfilm
