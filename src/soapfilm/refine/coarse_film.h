// The surface on every second vertex near holes, where it bends: fits, and signs that follow them.
#pragma once

#include <vector>

#include "soapfilm/refine/hole_finder.h"
#include "soapfilm/refine/robust_fit.h"
#include "soapfilm/refine/topology.h"

namespace soapfilm {

/// The surface on every second vertex near the holes, while it bends.
class CoarseFilm {
 public:
  /// All must outlive it. `fit_weights` is what the samples of the whole grid are fitted with.
  CoarseFilm(const Level& fine, float threshold, const HoleFinder& finder, const FitWeights& fit_weights,
             const Context& context);

  /// Fits, signs that follow at simple points, and again until hardly one does, in 12 rounds at most. Returns false
  /// where more of them turn than in the first round, held by the topology: this ends nowhere.
  bool bend(const std::vector<HoleFilm>& films, HoleReport& report);

  const BrickMask& bricks() const { return bricks_; }
  /// About the distance in units of every second vertex; beyond the band its sign alone.
  float distance(Vec3i vertex) const;

 private:
  void make_level();
  FlipCount step();

  const Level& fine_;
  float threshold_;
  const HoleFinder& finder_;
  const Context& context_;
  FitWeights strength_;
  RobustParams robust_;
  BrickMask bricks_;  // of the band: those that hold films, and those next to them
  Level level_;       // the indicator, on one more brick around
  Start start_;
  RowArray phi_;
};

}  // namespace soapfilm
