// The terms of the energy that are linear in u: each adds its part to f. A further one is a row of the table in
// terms.cpp; the memory plan, cross-validation and the levels then see it, too.
#pragma once

#include "soapfilm/field/divergence.h"

namespace soapfilm {

/// f, the sum of all terms.
SupportField data_field(const GridSamples& samples, const LevelBox& box, const Context& context);

/// The bricks where it can differ from zero.
BrickMask data_bricks(const GridSamples& samples, const LevelBox& box, const Context& context);

/// a + b, on the bricks of both.
SupportField sum_of(const SupportField& a, const SupportField& b, const Context& context);

}  // namespace soapfilm
