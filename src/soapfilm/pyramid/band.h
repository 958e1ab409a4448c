// Which bricks a level works on.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The bricks of a level that is solved whole: those with free vertices, with the faces around these, and those of its
/// data, `support`. In the rest of the box, which is rounded up to whole bricks of the coarsest level and so may be
/// many times larger, u = 0 and p = 0.
BrickMask free_bricks(const LevelBox& box, const BrickGrid& support);

/// The band of the level below `coarse`: the bricks of its data, `support`, and of the children of the coarse bricks
/// those that hold
///   every pair of neighbors whose rounded u differ (the interface), and
///   every vertex I where sqrt(sum_k max(|P_k[I - e_k]|, |P_k[I]|)^2) > lambda: elsewhere the prolonged dual is
///   feasible on all finer levels (with the anisotropic norm it is everywhere: prolongation takes means), so leaving
///   the brick out costs the certificate nothing but this level's own gap.
/// The finest level leaves bricks of its data out that lie two vertices and more from the interface and whose data the
/// prolonged state serves already, as long as this adds no more than `allowed` to the gap.
BrickMask choose_band(const Level& coarse, const LevelBox& box, const SupportField& support, double allowed,
                      const Context& context);

/// The bricks just outside the band that its interface has reached (rounded u differs across the rim) and whose parent
/// the coarse band holds: where the band must grow.
BrickMask growth(const Level& level, const BrickGrid& coarse, const Context& context);

/// `band` and the bricks beside it whose parents the coarse band holds: for a band that does not converge. A rim close
/// to where the flux must turn may fix a flux that the finer ball cannot carry on.
BrickMask widened(const BrickMask& band, const BrickGrid& coarse);

}  // namespace soapfilm
