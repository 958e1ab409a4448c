// What a level's surface is to the next finer one.
#pragma once

#include "soapfilm/grid/layout.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// The distance from a level's surface, in its voxels, at a vertex of the next finer level; as far as it is known.
float distance_at_finer(const DistanceField& coarse, Vec3i fine_vertex);

}  // namespace soapfilm
