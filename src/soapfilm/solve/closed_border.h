// What the stages after the solve make of an open solution: its inside ends at the border of the box.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The same u, where the u = 0 of fixed vertices now means outside, on bricks that are added to the band along the
/// border: components and cavities are those of the surface that is closed there. The box stays open, so that nobody
/// draws or fits what closes it: InsideBits::interface() has none of it. Without p and f.
Level closed_at_border(const Level& level, const Context& context);

}  // namespace soapfilm
