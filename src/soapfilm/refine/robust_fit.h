// The displacement under a robust penalty: weigh the samples, solve, and again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/refine/displacement.h"
#include "soapfilm/kernels/robust.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// What the fit trusts.
struct FitWeights {
  double smoothing = 0;  ///< gamma: weight of curvature against one sample, lattice units
  double normals = 0;    ///< weight of a direction's error (as a vector of unit length) against a voxel
  double noise = 0;      ///< standard deviation of the samples along the surface's normal, voxels
  bool yield = false;    ///< whether curvature counts less where the surface bends most: under noise
};

/// The same on a grid of half the voxel, where phi is twice as large and the surface has four times the vertices.
inline FitWeights on_half_the_voxel(const FitWeights& s) { return {4 * s.smoothing, 4 * s.normals, 2 * s.noise, s.yield}; }

struct RobustParams {
  Penalty penalty = Penalty::tukey;
  double least_scale = 0.1;     ///< of the penalty, voxels, [1e-3, 10]
  double scale_of_noise = 2.5;  ///< the scale over the noise, where that is larger, [1, 10]: samples of detail that
                                ///< the first fits smooth away must not weigh less for it
  double first_scale = 0.5;     ///< at least this in the first round, half of it in the next, ...: voxels, >= 0
  double slope = 2;             ///< weight of a unit slope along the normal against gamma, >= 0: without it phi
                                ///< flattens among noisy samples and is no distance any more
  double slope_along_directions = 8;  ///< instead of `slope` where directions are used and curvature yields, >= 0: what
                                      ///< neighbors that were seen from different sides say of the normal between
  double slope_of_curvature = 0.02;   ///< beta / sqrt(gamma), > 0: gamma scales as length^4, beta as length^2
  int rounds = 3;  ///< of weighing and solving where curvature does not yield, at most, [1, 20]; the second or a later
                   ///< one is the last where the scale has come down to the noise
  std::vector<int> yielding_steps = {2, 3, 2, 4};  ///< where curvature yields: at most so many iterations in each round
                                                   ///< of weighing, yielding and solving, >= 1; they go on from one
                                                   ///< another. Fewer in the first leave smooth faces rough, in the
                                                   ///< last ones thin parts
  double yielding_bend = 1.2;                      ///< what it yields to, in medians of the surface's bends, > 0
  SolveLimits solve;  ///< of the last round; the first takes a quarter of the iterations, others a sixth; where
                      ///< curvature yields its tolerance alone counts

  /// Of the penalty, voxels, once the first rounds are over.
  double scale(double noise) const { return std::max(least_scale, scale_of_noise * noise); }
};

struct RobustFit {
  size_t down_weighted = 0;  ///< samples of weight < 1/4, those that the band does not see included
  int iterations = 0;
};

/// Moves `displacement` onto the samples, from what it yields to at present; `active[s]` 0 leaves a sample out, where
/// there is any. `cells` are those of the samples: room to merge them in.
RobustFit fit_robustly(Displacement& displacement, const GridSamples& samples, CellSamples& cells,
                       std::span<const uint8_t> active, const FitWeights& fit_weights, const RobustParams& params,
                       const Context& context);

}  // namespace soapfilm
