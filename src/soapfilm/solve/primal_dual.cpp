#include "soapfilm/solve/primal_dual.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/solve/sweep.h"

namespace soapfilm {

namespace {

/// The iteration converges for tau sigma |grad|^2 < 4/3 (Li and Yan 2022, "On the improved conditions for some
/// primal-dual algorithms"), where |grad|^2 <= 12: a third more than Chambolle and Pock's own bound.
constexpr double step_product = 1.3 / 12;

/// Iterations until the next look at the gap. It falls about as 1 / iterations^2, so where it will pass the tolerance
/// can be told.
int until_next_check(int iterations, double gap, const PrimalDualParams& params) {
  const double left = iterations * (std::sqrt(gap / params.tolerance) - 1);
  return left < params.check_every ? std::max(1, static_cast<int>(std::ceil(left))) : params.check_every;
}

}  // namespace

PrimalDualReport solve_primal_dual(Level& level, const PrimalDualParams& params, const Parallel& parallel,
                                   Progress& progress,
                                   const std::function<void(int iterations, const Energies&)>& observe) {
  const double sigma = params.step_balance * level.lambda;
  const StepSizes steps{static_cast<float>(sigma), static_cast<float>(step_product / sigma)};
  Sweeper sweeper(level, parallel);
  PrimalDualReport report;
  int check_after = params.check_every;
  while (report.iterations < params.max_iterations && !report.converged) {
    const int sweeps = std::min(check_after, params.max_iterations - report.iterations);
    progress.check();
    sweeper.sweep(steps, sweeps);
    report.iterations += sweeps;
    report.energies = evaluate_energy(level, {}, parallel);
    const double gap = report.energies.relative_gap_band(level.lambda);
    report.converged = gap <= params.tolerance;
    check_after = until_next_check(report.iterations, gap, params);
    if (observe) observe(report.iterations, report.energies);
  }
  return report;
}

}  // namespace soapfilm
