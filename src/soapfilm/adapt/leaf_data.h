// The data of leaves of several levels: each sample's on the level of its place.
#pragma once

#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/field/samples.h"

namespace soapfilm {

/// f of each level, the finest first: on the bricks of its leaves each sample's f of the level that its place has,
/// summed over finer vertices where its smoothing reaches coarser leaves, an eighth of it for each where it reaches
/// finer ones; on bricks with finer leaves the sum of these. `samples`: on the placed level, lattice.added.
std::vector<SupportField> data_of_leaves(const GridSamples& samples, const Regions& regions, const Lattice& lattice,
                                         const Context& context);

}  // namespace soapfilm
