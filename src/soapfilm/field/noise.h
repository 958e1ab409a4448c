// The noise of the samples: the grid should not be much finer.
#pragma once

#include <span>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Standard deviation of the samples along the normal of their surface, input units; 0: it cannot be told. Half of them
/// have less. For each of some five hundred samples the plane through its nearest neighbors is taken at the smallest
/// number of them, 32 to 4,096 of at most 100,000 samples, whose thickness is small beside its width: inside the noise
/// neighbors fill a ball, on edges and in dense vegetation they never become thin; where many of them have one height,
/// what lies over them is vegetation and tells nothing. Neighbors whose direction (zero: unknown) is more than 60
/// degrees from the sample's are on the other side of a sheet, or behind an edge, and do not count. Curvature adds to
/// the noise. Noise does not change when samples are thinned, so of the larger neighborhoods 64 are used.
/// Deterministic.
double measure_noise(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Context& context);

}  // namespace soapfilm
