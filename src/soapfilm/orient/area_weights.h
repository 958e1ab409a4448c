// Each sample stands for its area: what the voxel and the samples' weights follow from.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/orient/local_surface.h"

namespace soapfilm {

/// What LocalSurface::coverage holds, of its columns. Sums go over the samples, in their order.
AreaCoverage cover_area(const LocalSurface& surface);

/// A weight for each sample, 1 on the mean: the area that it stands for over the mean one, so that an area counts alike
/// however many samples it has. Within a factor of 1.5 it is 1 (what is measured of even samples scatters by less), and
/// beyond it changes on from there, up to `most` >= 1. Samples without a plane weigh 1, those on edges and rods up
/// to 16.
std::vector<float> weigh_by_area(const LocalSurface& surface, double most, const Context& context);

}  // namespace soapfilm
