// Converts an open solution to a closed one, for stages that handle only closed surfaces.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The same u, where the u = 0 of fixed vertices now means outside: the surface is closed along the border of the box,
/// on bricks that are added to the band there. Without p and f.
Level closed_at_border(const Level& level, const Context& context);

}  // namespace soapfilm
