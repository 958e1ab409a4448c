// What goes from rank to rank of a level in slabs.
#pragma once

#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Brings u, p and rim of some bricks, `wanted` of each rank, from the slabs that own them. The level is the same: of
/// it this rank has more.
void bring_bricks(const Level& level, const std::vector<ItemRange>& wanted);
/// Brings u and p of the layers next to each slab.
void bring_borders(Level& level);
/// Brings everything: the level has no slabs any more.
void complete(Level& level);

}  // namespace soapfilm
