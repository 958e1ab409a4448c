// How far a place is from the samples, where only the order of some voxels matters.
#pragma once

#include "soapfilm/field/samples.h"

namespace soapfilm {

/// Distance from `place` (lattice coordinates) to the nearest sample, voxels, clamped to [enough, limit]: the search
/// ends once a sample is as near as `enough`, and looks no farther than `limit`. 0 <= enough <= limit. Needs no memory
/// of its own; takes time in proportion to limit^3 for places that have no sample near.
double distance_to_samples(const GridSamples& samples, Vec3d place, double enough, double limit);

}  // namespace soapfilm
