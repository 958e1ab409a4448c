// What lies around the places of a level.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// Of a brick whose parent has these: each vertex as the coarse one that holds it.
BrickBits bits_of_child(const BrickBits& parent, Vec3i brick);

/// The labels of a level in some places, on all bricks near its surface, and on the bricks around these beyond the
/// places those of the next coarser level: so the surface goes on where the places end.
Labels with_surroundings(const Labels& fine, const Labels& coarse, const Context& context);

}  // namespace soapfilm
