// The noise of the samples, from their positions alone: the grid should not be much finer.
#pragma once

#include <span>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Standard deviation of the samples along the normal of their surface, input units; 0: it cannot be told. Half of them
/// have less. For each of some five hundred samples the plane through its nearest neighbors is taken at the smallest
/// number of them, 32 to 4,096 of at most 100,000 samples, whose thickness is small beside its width: inside the noise
/// neighbors fill a ball, on edges and in dense vegetation they never become thin; where many of them have one height,
/// what lies over them is vegetation and tells nothing. Curvature adds to the noise. Noise does not change when samples
/// are thinned, so of the larger neighborhoods 64 are used. Deterministic.
double measure_noise(std::span<const Vec3d> positions, const Context& context);

}  // namespace soapfilm
