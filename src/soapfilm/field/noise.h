// The noise of the samples, from their positions alone: the grid should not be much finer.
#pragma once

#include <span>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Standard deviation of the samples along the normal of their surface, input units; 0: it cannot be told. Half of them
/// have less. For each of some five hundred samples the plane through the nearest of a subset is taken at the smallest
/// number of them, 16 to 1,024, whose thickness is small beside its width: inside the noise neighbors fill a ball, on
/// vegetation and edges they never do otherwise. Deterministic.
double measure_noise(std::span<const Vec3d> positions, const Context& context);

}  // namespace soapfilm
