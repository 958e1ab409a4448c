// Levels from the sides of their leaves.
#pragma once

#include <span>
#include <vector>

#include "soapfilm/adapt/leaf_links.h"
#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/params.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// One for each level, the finest first, in its places: u is 0 or 1, in bricks with finer leaves that of most of them,
/// p = 0; on the bricks near its surface, and those of the data.
std::vector<Level> levels_of_sides(const LeafLinks& links, const LeafSet& inside, std::span<const SupportField> data,
                                   Norm norm, const Context& context);

}  // namespace soapfilm
