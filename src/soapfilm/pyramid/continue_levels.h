// Where the leaves of several levels start from (adapt/solve_leaves.h): each level's flux goes on in that of the next
// coarser one.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// A copy of u, p and what lies outside of a level; it refers to no data.
Level copy_of(const Level& level, const Context& context);

/// Another state of a level, whose u and p are known in some bricks.
struct KnownState {
  const Level& level;
  std::function<bool(Vec3i)> in;
};

/// Data that a level was solved for, and that it shall be solved for now.
struct NewData {
  const SupportField& before;
  const SupportField& now;
};

/// Gives a whole level other data. What it has outside of its bricks, which is counted for the data from before, then
/// is for the new one.
void change_data(Level& level, const NewData& data);

/// Takes u and p of bricks from the first state that knows them, but not the fluxes through faces at the band's end.
void take_known(std::span<const KnownState> known, Level& level, const Context& context);

/// A level in its places, `band` of them: where they end, and around the band, p is that of the coarse level; else what
/// is known first, and the coarse level's state.
Level continue_in_places(const Level& coarse, const LevelBox& box, const BrickMask& band,
                         std::shared_ptr<const BrickMask> places, std::span<const KnownState> known,
                         const SupportField& support, const Context& context);

}  // namespace soapfilm
