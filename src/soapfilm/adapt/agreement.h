// Whether a level's surface is that of the next finer level.
#pragma once

#include <span>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// Gives back to coarser levels what finer ones have from the borders on, as far as both disagree and no samples ask
/// for it: there the finer level spans films that begin where its samples become too sparse. Where only the balance
/// needs the finer level it keeps the places, with the coarser level's distances. `levels`: one field for each level of
/// the regions.
void give_back_disagreement(Regions& regions, std::span<DistanceField> levels, const Context& context);

}  // namespace soapfilm
