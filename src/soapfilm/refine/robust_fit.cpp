#include "soapfilm/refine/robust_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace soapfilm {

RobustFit fit_robustly(Displacement& displacement, const NarrowBand& band, const GridSamples& samples,
                       const BandSamples& where, std::span<const uint8_t> active, const Strength& strength,
                       const RobustParams& params, const Parallel& parallel) {
  constexpr size_t samples_per_task = 1 << 14;
  RobustFit fit;
  fit.weight.resize(samples.size());
  std::vector<Vec3f> normal(samples.size());
  const Smoothness smoothness{static_cast<float>(params.slope_of_curvature * std::sqrt(strength.smoothing)),
                              static_cast<float>(strength.smoothing)};
  // Once the scale rests, the samples have been weighed as they will be; bends go on being found.
  const double least_scale = std::max(params.least_scale, params.scale_of_noise * strength.noise);
  const double slope_weight = strength.yield && strength.normals > 0 ? params.slope_along_directions : params.slope;
  const int rounds = params.rounds + (strength.yield ? params.yielding_rounds : 0);
  displacement.drop_target();
  CellSamples data;
  bool last = false;
  for (int round = 0; !last; ++round) {
    if (strength.yield && round > 0) displacement.yield_to_bends(params.yielding_bend);
    const double first_scale = params.first_scale * std::pow(0.5, round);
    const auto scale = static_cast<float>(std::max(least_scale, first_scale));
    last = round + 1 >= rounds || (!strength.yield && round > 0 && first_scale <= least_scale);
    const std::vector<Jet> jets = jets_at_samples(displacement.phi(), samples, where, band, parallel);
    parallel.for_each(samples.size(), samples_per_task, [&](size_t s) {
      const bool speaks =
          where.cell_row[s] != 0 && active[s] != 0 && seen_from_outside(samples.direction[s], jets[s].gradient);
      const float slope = norm(jets[s].gradient);
      fit.weight[s] = speaks ? robust_weight(params.penalty, jets[s].value / std::max(slope, 0.3f), scale) : 0.0f;
      normal[s] =
          strength.normals > 0 ? normalized(samples.direction[s]) : -(jets[s].gradient / std::max(slope, 1e-3f));
    });
    data = merge(samples, where, band, fit.weight, normal,
                 {static_cast<float>(strength.normals),
                  static_cast<float>(std::max(slope_weight * strength.smoothing, strength.normals))},
                 parallel, std::move(data));
    fit.cells = data.count;
    // Weights change little from here on.
    if (round == 0 || !strength.yield) displacement.precondition(data, smoothness);
    // Weights need no more than a rough surface.
    SolveLimits limits = params.solve;
    if (strength.yield) {
      limits.iterations = std::max(1, limits.iterations / params.yielding_haste);
      if (!last) limits.iterations = std::max(2, limits.iterations / 4);
    } else if (!last) {
      limits.iterations = std::max(1, limits.iterations / (round == 0 ? 4 : 6));
    }
    fit.iterations += displacement.minimize(data, smoothness, limits);
  }
  return fit;
}

}  // namespace soapfilm
