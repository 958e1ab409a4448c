// The surface near holes, on the half-resolution grid (every second vertex), where it is curved: fits, and labels that
// follow them.
#pragma once

#include <vector>

#include "soapfilm/refine/fit/robust_fit.h"
#include "soapfilm/refine/holes/hole_finder.h"
#include "soapfilm/refine/topology/topology.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// The surface near the holes on the half-resolution grid, while it is being curved.
class CoarseHoleSurface {
 public:
  /// All must outlive it. `fit_weights`: those of the samples on the full grid.
  CoarseHoleSurface(const Labels& fine, const HoleFinder& finder, const FitWeights& fit_weights,
                    const Context& context);

  /// Fits, changes labels at simple points to follow the fit, and repeats until almost none changes, in 12 rounds at
  /// most. Returns false where more of them change than in the first round and the topology refuses more than 3 %: this
  /// would not end.
  bool bend(const std::vector<HoleSurface>& holes, HoleReport& report);

  const BrickMask& bricks() const { return bricks_; }
  /// visit(brick, how many of its labels changed in the last round).
  template <class Visit>
  void for_each_moving(Visit&& visit) const {
    for (size_t b = 0; b < start_.grid.size(); ++b)
      if (moving_[b] > 0) visit(start_.grid.coord(b), moving_[b]);
  }
  /// Approximate distance in units of the half-resolution grid; beyond the band only its sign.
  float distance(Vec3i vertex) const;

 private:
  void make_labels();
  FlipCount step();

  const Labels& fine_;
  const HoleFinder& finder_;
  const Context& context_;
  FitWeights fit_weights_;
  RobustParams robust_;
  BrickMask bricks_;  // of the band: those that hold holes, and those next to them
  Labels labels_;     // on these bricks and one more around them
  Start start_;
  RowArray phi_;
  std::vector<size_t> moving_;  // by brick of the start: labels that the last round changed
};

}  // namespace soapfilm
