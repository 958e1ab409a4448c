#include "soapfilm/solve/primal_dual.h"

#include <fmt/core.h>

#include <algorithm>

#include "soapfilm/solve/sweep.h"

namespace soapfilm {

PrimalDualReport solve_primal_dual(Level& level, const PrimalDualParams& params, const Parallel& parallel,
                                   Progress& progress,
                                   const std::function<void(int iterations, const Energies&)>& observe) {
  const double sigma = params.step_balance * level.lambda;
  const StepSizes steps{static_cast<float>(sigma), static_cast<float>(1.0 / (12.0 * sigma))};
  Sweeper sweeper(level, parallel);
  PrimalDualReport report;
  while (report.iterations < params.max_iterations && !report.converged) {
    const int sweeps = std::min(params.check_every, params.max_iterations - report.iterations);
    for (int i = 0; i < sweeps; ++i) {
      progress.check();
      sweeper.sweep(steps);
    }
    report.iterations += sweeps;
    report.energies = evaluate_energy(level, {}, parallel);
    report.converged = report.energies.relative_gap_band(level.lambda) <= params.tolerance;
    if (observe) observe(report.iterations, report.energies);
  }
  return report;
}

}  // namespace soapfilm
