// The surfaces of several levels as one: at each place the distances of the level that it has.
#pragma once

#include <span>
#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/leaves.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// Leaves around the surface, with its distances in voxels of their levels.
struct LeafField {
  std::vector<BrickGrid> grids;  ///< the finest level first
  std::vector<Field<float>> distances;
};

/// Of each level's field the bricks of its places. Where two levels disagree on the side of places that neither has
/// values for, both get leaves: there a wall joins their surfaces. `levels`: one field for each level of the regions.
LeafField join_levels(const Regions& regions, std::span<const DistanceField> levels, const Lattice& lattice,
                      const Context& context);

/// The side of a place without leaves: that of its level.
bool side_of_region(const Regions& regions, std::span<const DistanceField> levels, int level, Vec3i vertex);

}  // namespace soapfilm
