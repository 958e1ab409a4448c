// Levels of detail: a simplified mesh, simplified again and again.
#pragma once

#include <cstddef>
#include <vector>

#include "soapfilm/simplify.h"

namespace soapfilm {

/// At most `count` further meshes, each made of the one before at twice its tolerance; fewer where one would have no
/// fewer triangles. Distances of sets add up at most, so a report's `proved` is the sum of all steps: the distance from
/// the full mesh, of which `first` was made. The first tolerance must be > 0. Throws as simplify() does.
std::vector<Simplified> coarser_levels(const Simplified& first, size_t count, const Context& context);

}  // namespace soapfilm
