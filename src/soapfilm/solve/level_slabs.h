// What goes from rank to rank of a level in slabs.
#pragma once

#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Brings u, p and rim of some bricks, `wanted` of each rank, from the slabs that own them.
void bring_bricks(Level& level, const std::vector<ItemRange>& wanted);
/// Brings u and p of the layers next to each slab.
void bring_borders(Level& level);
/// Brings everything: the level has no slabs any more.
void complete(Level& level);

}  // namespace soapfilm
