// The energies of one surface on leaves of several levels, each brick on the level that its place has.
//
//   E(u) = lambda sum over groups w_g |grad u|_g - <f, u>,   w_g in faces of the placed level
//
// A group is a leaf's three differences to what lies above it. Where finer leaves lie there it has eight groups of an
// eighth of the weight, one for each of its octants: each sees the leaves that its own face touches. The flux through a
// face is the sum of its groups', so that D(p) = sum of min(0, grad^T p - f) <= E(u) for every u in [0, 1] and every p
// with |p| <= lambda in each group.
#pragma once

#include <span>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// What a level has in its places, and around them.
struct LeafLevel {
  const Labels* sides = nullptr;       ///< u; wherever the level has the places
  const SupportField* data = nullptr;  ///< f
  /// p: that of the coarsest level on the whole box, the others' continuing the next coarser one's in the children of
  /// bricks that finer levels have there (pyramid/continue_levels.h). A leaf's octants have its p alike.
  const Level* flux = nullptr;
};

struct LeafEnergies {
  Energies energies;      ///< as of the placed level: total variation in its faces
  double at_borders = 0;  ///< part of the gap that lies in bricks where levels meet
};

/// Of levels, the finest first. `placed`: the level in whose faces the variation is counted. In bricks without flux p
/// is that of the next coarser level; where that has none their data count as in D(0). p is rescaled where rounding has
/// left some of it outside of its ball.
LeafEnergies evaluate_leaves(const Regions& regions, std::span<const LeafLevel> levels, int placed,
                             const Context& context);

}  // namespace soapfilm
