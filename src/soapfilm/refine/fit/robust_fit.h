// The displacement under a robust penalty: weight the samples, solve, repeat.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/kernels/robust.h"
#include "soapfilm/refine/fit/displacement.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// The weights of the fit, and the noise.
struct FitWeights {
  double smoothing = 0;          ///< gamma: weight of curvature against one sample, lattice units
  double normals = 0;            ///< weight of a direction's error (as a vector of unit length) against a voxel
  double noise = 0;              ///< standard deviation of the samples along the surface's normal, voxels
  bool edge_preserving = false;  ///< edge-preserving reweighting: less curvature weight at edges; under noise
};

/// The same on a grid of half the voxel size, where phi is twice as large and the surface has four times the vertices.
inline FitWeights on_half_the_voxel(const FitWeights& s) {
  return {4 * s.smoothing, 4 * s.normals, 2 * s.noise, s.edge_preserving};
}

struct RobustParams {
  Penalty penalty = Penalty::tukey;
  double least_scale = 0.1;  ///< of the penalty function, voxels, [1e-3, 10]
  /// The scale is this times the noise, where that is larger, [1, 10]: it must not down-weight samples of detail that
  /// the first fits smooth away
  double scale_of_noise = 2.5;
  double first_scale = 0.5;  ///< at least this in the first round, half of it in the next, ...: voxels, >= 0
  /// Weight of a unit slope along the normal against gamma, >= 0: without it phi flattens among noisy samples and is no
  /// longer a distance
  double slope = 2;
  /// Instead of `slope` where directions are used, with edge-preserving reweighting, >= 0: neighboring samples seen
  /// from different sides determine the normal between them
  double slope_along_directions = 8;
  double slope_of_curvature = 0.02;  ///< beta / sqrt(gamma), > 0: gamma scales as length^4, beta as length^2
  /// Rounds of weighting and solving without edge-preserving reweighting, at most, [1, 20]; the second or a later one
  /// is the last where the scale has come down to the noise
  int rounds = 3;
  /// With edge-preserving reweighting: iterations, at most, in each round of weighting samples, reweighting curvature
  /// and solving, >= 1; each round starts from the last. Fewer in the first leave smooth faces rough, in the last ones
  /// thin parts
  std::vector<int> reweighting_steps = {2, 3, 2, 4};
  double reweighting_threshold =
      1.2;  ///< d0 of the reweighting, in medians of the surface's d (see reweight_curvature()), > 0
  /// Of the last round; the first takes a quarter of the iterations, others a sixth; with edge-preserving reweighting
  /// only its tolerance counts
  SolveLimits solve;

  /// Of the penalty function, voxels, after the first rounds.
  double scale(double noise) const { return std::max(least_scale, scale_of_noise * noise); }
};

struct RobustFit {
  size_t down_weighted = 0;  ///< samples of weight < 1/4, including those outside the band
  int iterations = 0;
};

/// Moves `displacement` onto the samples, starting from its present curvature weights; active[s] = 0 excludes a sample,
/// unless `active` is empty. `cells` are those of the samples: memory to merge them in.
RobustFit fit_robustly(Displacement& displacement, const GridSamples& samples, CellSamples& cells,
                       std::span<const uint8_t> active, const FitWeights& fit_weights, const RobustParams& params,
                       const Context& context);

}  // namespace soapfilm
