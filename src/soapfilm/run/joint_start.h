// Where the leaves of all levels start from, before they are solved jointly.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/run/other_levels.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// One level after the other, the coarsest first, each from what it was solved to, and where that is not known going on
/// in the next coarser one; the result begins with the finest. `data`: of each level's leaves. `left_out`: the gap that
/// the places without bricks of their level may have, each level's. Frees what the levels came from.
std::vector<Level> joint_start(SolvedLevels& solved, CoarseLevels& coarse, const std::vector<SupportField>& data,
                               double left_out, const Context& context);

}  // namespace soapfilm
