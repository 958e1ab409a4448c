// Whether levels that are solved one after the other agree.
#pragma once

#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// Gives back to a level what the next finer one has from its border on, as far as both disagree and no samples ask for
/// it: there the finer level spans films that begin where its samples become too sparse, and a solve of both would
/// start from these.
void give_back_disagreement(Regions& regions, int level, const Labels& coarse, const Labels& fine,
                            const Context& context);

}  // namespace soapfilm
