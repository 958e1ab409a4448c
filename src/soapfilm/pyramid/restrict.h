#pragma once

#include "soapfilm/core/parallel.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// Restriction of the data term to the next coarser level: the sum over each vertex's 8 children (section 4.3).
SupportField restrict_field(const SupportField& fine, const LevelBox& coarse, const Parallel& parallel);

}  // namespace soapfilm
