// The leaves of all levels solved as one problem: what levels that are solved one after the other cannot know is where
// films across their borders are shortest.
#pragma once

#include <functional>
#include <span>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// A level's bricks that others of their level touch, and that of another level's leaves have values: in each level's
/// grid, so that it can be iterated with what lies there. `level`: the bricks of a level that are solved; `coarser`:
/// the grid of the next coarser one, which has the parents of all of them.
BrickMask with_followers(const Regions& regions, int level, BrickMask bricks, const BrickGrid& coarser);

struct LeafIteration {
  double balance = 1;   ///< sigma of a level is this times its lambda
  int most = 0;         ///< iterations
  int check_every = 1;  ///< iterations
};

/// One primal-dual iteration (solve/sweep.h) on the leaves of all levels, the finest first, whose grids have their
/// followers. A coarse leaf's flux to finer ones follows the difference to their mean, and what flows in from finer
/// ones is the sum of theirs. Leaves that a level's grid lacks, and bricks that finer levels have, stay as they are.
/// Ends early when ends(iterations) says so.
void solve_leaves(const Regions& regions, std::span<Level> levels, const LeafIteration& how, const Context& context,
                  const std::function<bool(int)>& ends);

}  // namespace soapfilm
