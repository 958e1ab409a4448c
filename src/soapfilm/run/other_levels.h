// The levels around the placed one, where samples are dense or sparse: their solves and surfaces.
#pragma once

#include <vector>

#include "soapfilm/adapt/level_samples.h"
#include "soapfilm/context.h"
#include "soapfilm/params.h"
#include "soapfilm/place/place.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/run/adapt.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/trace.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// What all levels have from the placed one.
struct LevelTask {
  const Grid& grid;
  double lambda;
  const ReconstructParams& params;
  const RobustParams& robust;
  const PyramidObserver& observe;  ///< is told of each finer level, from -1 down
};

/// A solved level, its data, and where components and cavities of it were dropped.
struct PlacedLevel {
  Level level;
  SupportField data;
  std::vector<BrickBits> dropped;  ///< vertices that have changed sides, of each brick
};

/// The level with the sides of `labels`, which are its own, u > threshold, without what was dropped.
PlacedLevel with_sides(Level level, SupportField data, float threshold, const Labels& labels, const Context& context);

/// Which levels places have by their samples; the levels below the placed one, where samples are dense, solved from
/// it, the next finer one from each level; and those above it, where they are sparse, in the same way. Each continues
/// what it comes from where its places end, and is moved onto its samples; directions
/// are those of the solve. Levels that do not fit into the memory are left out, with a warning.
AdaptedSurface find_other_surfaces(const LevelSamples& samples, PlacedLevel placed, const LevelTask& task,
                                   MemoryBudget& memory, Trace& trace, const Context& context);

}  // namespace soapfilm
