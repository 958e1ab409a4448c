// The fit on every second vertex, or every fourth, ...: where samples are sparser than the grid, a finer one adds
// unknowns and no detail.
#pragma once

#include "soapfilm/refine/robust_fit.h"
#include "soapfilm/refine/start.h"
#include "soapfilm/refine/fit_weights.h"

namespace soapfilm {

/// The problem on every second vertex of a finer grid, in lattice units of its own.
struct Coarser {
  Start start;
  GridSamples samples;
  FitWeights fit_weights;
  FitWeightReport search;
};

/// What one grid is fitted with, against a coarser one.
struct Finer {
  const Start& start;
  const GridSamples& samples;
  FitWeights fit_weights;
};

/// Whether a coarser fit serves as well: samples that neither saw lie at most 3 % farther from it on the mean. Both are
/// fitted to the same patches, as choose_fit_weights() does. False where no such sample is seen.
bool serves(const Coarser& coarse, const Finer& finer, const RobustParams& robust, const Context& context);

/// Whether phi, from a coarser fit, is still about this surface: where a part was too thin for the coarser cells it
/// lies more than `far` voxels from where it was, or the coarser band is not there and phi is what it was. One in 500
/// of the vertices within a voxel of the surface may.
bool is_near(const Start& start, const RowArray& phi, double far, const Context& context);

}  // namespace soapfilm
