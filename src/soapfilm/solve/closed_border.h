// What the stages after the solve make of an open solution: its inside ends at the border of the box.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// The same labels, where the 0 of fixed vertices now means outside, on bricks that are added to the grid along the
/// border: components and cavities are those of the surface that is closed there. The box stays open, so that nobody
/// draws or fits what closes it: LabelView::interface() has none of it.
Labels closed_at_border(const Labels& labels, const Context& context);

}  // namespace soapfilm
