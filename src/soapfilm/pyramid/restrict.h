#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// Restriction of the data term to the next coarser level: the sum over each vertex's 8 children (section 4.3), in the
/// order of their vertices, x fastest; on the context's device.
SupportField restrict_field(const SupportField& fine, const LevelBox& coarse, const Context& context);

/// The data terms of levels 1 to levels - 1 of the lattice, each restricted from the one before.
std::vector<SupportField> coarser_fields(const SupportField& finest, const Lattice& lattice, int levels,
                                         const Context& context);

}  // namespace soapfilm
