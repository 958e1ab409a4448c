// The bricks on which a level is solved.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The bricks of a level that is solved without a coarser one's surface: all those with free vertices, including the
/// faces around these, and those of its data, `support`; if these are more than `most` times the support's, and many,
/// only blocks of bricks around the support, the largest that are not too many. In the rest of the box u = 0 and p = 0.
BrickMask start_bricks(const LevelBox& box, const BrickGrid& support, double most);

/// The band of the level below `coarse`: the bricks of its data, `support`, and those children of the coarse bricks
/// that hold
///   every pair of neighbors whose rounded u differ (the interface), and
///   every vertex I where sqrt(sum_k max(|P_k[I - e_k]|, |P_k[I]|)^2) > lambda: elsewhere the prolonged dual is
///   feasible on all finer levels (with the anisotropic norm it is everywhere: prolongation takes means), so leaving
///   the brick out adds only this level's own gap to the certificate.
/// The finest level leaves out bricks of its data at least two vertices from the interface if the prolonged state
/// already fits their data, as long as this adds no more than `allowed` to the gap.
BrickMask choose_band(const Level& coarse, const LevelBox& box, const SupportField& support, double allowed,
                      const Context& context);
/// The same for a level that covers only these places: of its data the bricks whose parents the coarse level has.
BrickMask choose_band_in(const BrickMask& places, const Level& coarse, const LevelBox& box, const SupportField& support,
                         const Context& context);

/// The bricks just outside the band that its interface has reached (rounded u differs across the band boundary) and
/// whose parent is in the coarse band, if there is one: where the band must grow. None that the level does not cover.
BrickMask growth(const Level& level, const BrickGrid* coarse, const Context& context);

/// `band` and its neighboring bricks whose parents are in the coarse band: for a band that does not converge. A band
/// boundary close to where the flux must change direction may fix a flux that is not feasible on the finer level.
BrickMask widened(const BrickMask& band, const BrickGrid& coarse);

}  // namespace soapfilm
