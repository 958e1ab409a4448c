// The fit on every second vertex, or every fourth, ...: where samples are sparser than the grid, a finer one adds
// unknowns and no detail.
#pragma once

#include <vector>

#include "soapfilm/refine/robust_fit.h"
#include "soapfilm/refine/start.h"

namespace soapfilm {

/// The problem on every second vertex of a finer one.
struct Coarser {
  Start start;
  GridSamples samples;
};

/// Every second vertex, every fourth, ..., until there are at least `sparse` samples per square of their own spacing.
std::vector<Coarser> coarser_problems(const Level& level, float threshold, const GridSamples& samples, double density,
                                      double sparse, double reach, const Parallel& parallel);

/// Whether a fit of this strength serves as well as one on the finer grid: samples that neither saw lie at most 3 %
/// farther from it on the mean. Both are fitted to the same patches, as choose_strength() does.
bool serves(const Coarser& coarse, const Strength& strength, const Start& finer, const GridSamples& finer_samples,
            const RobustParams& robust, const Parallel& parallel);

/// Whether phi, from a coarser fit, is still about this surface everywhere: where a part was too thin for the coarser
/// cells it lies `far` voxels from where it was. One in 500 vertices at the surface may.
bool is_near(const Start& start, const RowArray& phi, double far, const Parallel& parallel);

}  // namespace soapfilm
