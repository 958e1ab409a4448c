// An open solution as a closed one: for stages that know closed surfaces alone.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The same u, with u = 0 at fixed vertices taken at its word: the surface is closed along the border of the box, on
/// bricks that the band gains there. Without p and f.
Level closed_at_border(const Level& level, const Context& context);

}  // namespace soapfilm
