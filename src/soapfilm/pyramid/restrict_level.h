// From a solved level to the next coarser one, for places where a coarser solution is wanted.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The next coarser level on `bricks`, which hold the parents of the fine level's, with 4 times its lambda: u as the
/// mean of a vertex's free children, p as the sum of the fluxes through the four faces of its children. Where the fine
/// level stores none, far from its surface, p = 0.
Level restrict_level(const Level& fine, const LevelBox& box, const BrickMask& bricks, const SupportField& support,
                     const Context& context);

}  // namespace soapfilm
