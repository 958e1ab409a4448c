// The levels around the placed one, where samples are dense or sparse: their solves and surfaces.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
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

/// The levels above the placed one as its solve leaves them: their flux is known wherever finer levels' is.
class CoarseLevels {
 public:
  explicit CoarseLevels(const Context& context) : context_(context) {}
  /// `user`, which also keeps the levels.
  PyramidObserver watch(PyramidObserver user);
  uint64_t bytes() const;
  void clear() { levels_.clear(); }
  /// So many levels above the placed one; null where that was not solved with all of lambda.
  Level* find(int above);

 private:
  const Context& context_;
  std::vector<Level> levels_;
};

/// A level's solution by itself.
struct SolvedLevel {
  Level level;
  std::unique_ptr<SupportField> data;

  uint64_t bytes() const;
};

/// Levels solved one after the other, for solve_jointly().
struct SolvedLevels {
  Lattice lattice;  ///< of the finest level; the placed one is its level `lattice.added`
  Regions regions;
  std::vector<SolvedLevel> levels;   ///< the finest first
  std::vector<LevelReport> reports;  ///< of those below the placed one, the finest last
  std::optional<LevelSamples> kept;  ///< the samples that are not near something dropped, where that is not all
};

/// Which levels places have by their samples; the levels below the placed one, where samples are dense, solved from it,
/// the next finer one from each level; and those above it, where they are sparse, in the same way. Each continues what
/// it comes from where its places end. Levels that do not fit into the memory are left out, with a warning.
SolvedLevels solve_other_levels(const LevelSamples& samples, PlacedLevel placed, const LevelTask& task,
                                MemoryBudget& memory, Trace& trace, const Context& context);

/// The surfaces of the others than the placed level, from the sides of each in its places (adapt/leaf_labels.h): the
/// coarsest first, as each goes on in the surface of the next coarser one, moved onto its samples. The placed level's
/// sides then are those of the whole box.
AdaptedSurface find_other_surfaces(const LevelSamples& samples, const SolvedLevels& solved, std::vector<Labels>& sides,
                                   const LevelTask& task, const Context& context);

}  // namespace soapfilm
