// From a solved level to the next finer one. Fine vertex x lies in coarse vertex x >> 1 (a cell of 2 x 2 x 2).
#pragma once

#include <memory>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The next finer level on `band`, its state prolonged from `coarse`:
///   u by trilinear interpolation (fine vertices at -1/4 and +1/4 of the coarse one: weights 3/4 and 1/4),
///   p as face fluxes: the flux of a coarse face is given to the matching fine faces, a face inside a coarse cell has
///   the mean of its two parallel neighbors, all times 1/4 (lowest-order Raviart-Thomas: keeps the divergence), the
///   band boundary's fluxes, u outside, and the contribution of the outside to D and to the gap, exactly.
/// On the context's device (Device::prolong_state); bits, in float: u as 0.75 near + 0.25 far along x, then y, then z,
/// a mean flux as 0.25 (0.5 (below + upper)). `band` may hold only children of the coarse band's bricks; all children
/// of its support bricks must be among these.
/// Where the context has ranks it comes in slabs, and what a rank lacks of `coarse` is brought there.
Level prolong_level(const Level& coarse, const LevelBox& box, const BrickMask& band, const SupportField& support,
                    const Context& context);
/// The same, but bricks of `previous` (the same level on a smaller band) keep their state; the memory of its u and p is
/// freed as they are copied.
Level prolong_level(const Level& coarse, const LevelBox& box, const BrickMask& band, const SupportField& support,
                    const Context& context, Level&& previous);
/// The same without `previous`, but u and p of `coarse` are freed as they are used: afterwards only its grid may be
/// used.
Level prolong_level(Level&& coarse, const LevelBox& box, const BrickMask& band, const SupportField& support,
                    const Context& context);

/// A level in some places of its box only: these bricks, the children of bricks that the coarse level covers. `band`
/// holds only such bricks, `previous` may be null. Beyond its places the level has no energy: where they end p keeps
/// the coarse level's flux, so that what lies there stays a part of one feasible dual.
Level prolong_in_places(const Level& coarse, const LevelBox& box, const BrickMask& band,
                        std::shared_ptr<const BrickMask> places, const SupportField& support, const Context& context,
                        Level* previous);

}  // namespace soapfilm
