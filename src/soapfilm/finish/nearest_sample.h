// Distance of a position to the samples, where only the order of a few voxels matters.
#pragma once

#include "soapfilm/field/samples.h"

namespace soapfilm {

/// Distance from `place` (lattice coordinates) to the nearest sample, voxels, clamped to [enough, limit]: the search
/// ends once a sample is as near as `enough`, and covers no more than `limit`. 0 <= enough <= limit. Needs no memory;
/// takes time proportional to limit^3 for positions without samples nearby.
double distance_to_samples(const GridSamples& samples, Vec3d place, double enough, double limit);

}  // namespace soapfilm
