// How much of a closed surface is there only to close it.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Share of the relaxed surface's area, [0, 1], that the data does not support: within five vertices outside of it,
/// along an axis, f takes less than a tenth of `flux`. A sheet's back is half of its closed surface. `flux`: the mean
/// flux of the samples' directions through a face of this level, in units of f.
double closing_share(const Level& level, double flux, const Context& context);

}  // namespace soapfilm
