// One dual for leaves of several levels: each level's flux goes on in that of the next coarser one.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "soapfilm/context.h"
#include "soapfilm/params.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// A copy of u, p and what lies outside of a level; it refers to no data.
Level copy_of(const Level& level, const Context& context);

/// Another state of a level that knows its p in some bricks. Where it is settled nothing has to change but at ends.
struct KnownFlux {
  const Level& level;
  std::function<bool(Vec3i)> in;
  bool settled;
};

/// p of a whole level for its data, `support`. It starts as a solution for nearly the same data; takes what is known,
/// in this order, and is solved on where that is not settled. What it has outside of its bricks is counted for this
/// data.
void continue_flux(Level& level, std::span<const KnownFlux> known, const SupportField& support,
                   const PrimalDualParams& params, const Context& context);

/// p of a level in its places, `band` of them: where they end, and around the band, that of the coarse level; else what
/// is known, solved on as above.
Level flux_in_places(const Level& coarse, const LevelBox& box, const BrickMask& band,
                     std::shared_ptr<const BrickMask> places, std::span<const KnownFlux> known,
                     const SupportField& support, const PrimalDualParams& params, const Context& context);

}  // namespace soapfilm
