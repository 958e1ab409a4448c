// Whether a level's surface is that of its samples, and that of the next finer level.
#pragma once

#include <span>
#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// The bricks of a level in which its surface is not that of its samples: at least two of them, and more than a tenth,
/// are farther from it than a voxel. So edges and small things get finer levels, unless the samples are more than four
/// voxels of these apart: there they make lumps. `number`: the level's.
std::vector<Vec3i> misfits(const LevelSamples& level, int number, const DistanceField& field, const Context& context);

/// Gives back to coarser levels what finer ones have from the borders on, as far as both disagree and no samples ask
/// for it: there the finer level spans films that begin where its samples become too sparse. Where only the balance
/// needs the finer level it keeps the places, with the coarser level's distances. `levels`: one field for each level of
/// the regions.
void give_back_disagreement(Regions& regions, std::span<DistanceField> levels, const Context& context);

}  // namespace soapfilm
