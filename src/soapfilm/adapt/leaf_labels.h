// The sides of all levels, from the solution on their leaves.
#pragma once

#include <span>
#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/solve/level.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// For each level, the finest first, where it or finer levels have the places: in its own u > threshold, elsewhere the
/// side of most of the finer vertices.
std::vector<Labels> labels_of_leaves(const Regions& regions, std::span<const Level> levels, float threshold,
                                     const Context& context);

/// The labels of a level in its places, and beyond these, in the whole box, on which side of the next coarser level's
/// surface they are.
Labels continued_beyond(const Labels& own, const DistanceField& coarser, const Context& context);

}  // namespace soapfilm
