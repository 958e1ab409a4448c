// Levels finer and coarser than one of the whole box, each in some places of it.
#pragma once

#include <memory>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

/// The level below `coarse` in some places: these bricks of `box`, the children of bricks that the coarse level covers.
/// It starts from the coarse solution and keeps its flux where the band ends (prolong_in_places()); in bricks without
/// data in or next to them, and in the last ones of the places, its surface stays the coarse level's. On a band that
/// grows within the places until the interface stays inside. Without bricks where the coarse level has no surface in
/// them. `report`: of the work; energies are of the places only.
Level solve_in_places(const Level& coarse, const LevelBox& box, std::shared_ptr<const BrickMask> places,
                      const SupportField& support, const PrimalDualParams& params, const Context& context,
                      LevelReport& report);

/// `alone`, a solution of the level above `fine` by itself, so that in other than these places, bricks of `box`, it is
/// what the fine level says (restrict_level()): the surface of the places then goes on in that of the fine level where
/// they end. The band grows in the places until the interface stays inside.
Level solve_coarser_in_places(const Level& fine, const Level& alone, const LevelBox& box, const BrickMask& places,
                              const SupportField& support, const PrimalDualParams& params, const Context& context,
                              LevelReport& report);

}  // namespace soapfilm
