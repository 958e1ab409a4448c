#include "soapfilm/refine/fit/robust_fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace soapfilm {

RobustFit fit_robustly(Displacement& displacement, const GridSamples& samples, CellSamples& cells,
                       std::span<const uint8_t> active, const FitWeights& fit_weights, const RobustParams& params,
                       const Context& context) {
  RobustFit fit;
  const Smoothness smoothness{static_cast<float>(params.slope_of_curvature * std::sqrt(fit_weights.smoothing)),
                              static_cast<float>(fit_weights.smoothing)};
  // Without edge-preserving reweighting, the sample weights are final once the scale is; with it, more rounds find
  // edges.
  const double least_scale = params.scale(fit_weights.noise);
  const double slope_weight =
      fit_weights.edge_preserving && fit_weights.normals > 0 ? params.slope_along_directions : params.slope;
  const int rounds = fit_weights.edge_preserving ? static_cast<int>(params.reweighting_steps.size()) : params.rounds;
  displacement.drop_target();
  bool last = false;
  for (int round = 0; !last; ++round) {
    if (fit_weights.edge_preserving && round > 0) displacement.reweight_curvature(params.reweighting_threshold);
    const double first_scale = params.first_scale * std::pow(0.5, round);
    const auto scale = static_cast<float>(std::max(least_scale, first_scale));
    last = round + 1 >= rounds || (!fit_weights.edge_preserving && round > 0 && first_scale <= least_scale);
    merge(displacement.phi(), samples, displacement.band(), {params.penalty, scale, fit_weights.normals > 0, active},
          {static_cast<float>(fit_weights.normals),
           static_cast<float>(std::max(slope_weight * fit_weights.smoothing, fit_weights.normals))},
          context, cells);
    fit.down_weighted = cells.doubted;
    // From here on the weights change little.
    if (round == 0 || !fit_weights.edge_preserving) displacement.precondition(cells, smoothness);
    SolveLimits limits = params.solve;
    if (fit_weights.edge_preserving)
      limits.iterations = params.reweighting_steps[static_cast<size_t>(round)];
    else if (!last)  // for the sample weights a rough surface suffices
      limits.iterations = std::max(1, limits.iterations / (round == 0 ? 4 : 6));
    fit.iterations += displacement.minimize(cells, smoothness, limits);
    context.progress().advance((round + 1.0) / rounds, fmt::format("round {} of {}", round + 1, rounds));
  }
  return fit;
}

}  // namespace soapfilm
