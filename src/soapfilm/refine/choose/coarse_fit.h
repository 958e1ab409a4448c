// The fit on every second vertex, or every fourth, ...: where samples are farther apart than grid vertices, a finer
// grid adds unknowns and no detail.
#pragma once

#include "soapfilm/refine/choose/fit_weights.h"
#include "soapfilm/refine/fit/robust_fit.h"
#include "soapfilm/refine/topology/start.h"

namespace soapfilm {

/// The problem on every second vertex of a finer grid, in lattice units of its own.
struct CoarseFit {
  Start start;
  GridSamples samples;
  FitWeights fit_weights;
  FitWeightReport search;
};

/// The start, samples and weights of the finer grid that a coarser one is compared with.
struct FineProblem {
  const Start& start;
  const GridSamples& samples;
  FitWeights fit_weights;
};

/// Whether a coarser fit is as good: the mean distance of held-out samples is at most 3 % larger. Both are fitted to
/// the same patches, as choose_fit_weights() does. False where there is no held-out sample in the band.
bool suffices(const CoarseFit& coarse, const FineProblem& finer, const RobustParams& robust, const Context& context);

/// Whether phi, from a coarser fit, still describes this surface. A vertex within a voxel of the surface fails where
/// phi differs by more than `far` voxels from its first value (a part was too thin for the coarser cells), or where the
/// coarser band does not exist and phi is unchanged. One in 500 of them may fail.
bool is_near(const Start& start, const RowArray& phi, double far, const Context& context);

}  // namespace soapfilm
