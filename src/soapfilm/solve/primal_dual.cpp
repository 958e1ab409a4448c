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

/// Where the gap has come to this multiple of the tolerance, sigma is halved and tau doubled: what is left is mostly u
/// on its way between 0 and 1 where data is scarce, and p has settled. The gap then falls as if this many of the
/// iterations were left.
constexpr double late_gap = 10;
constexpr double late_balance = 0.5;
constexpr double late_iterations = 0.7;

/// Iterations that are left: the gap falls about as 1 / iterations^2.
double iterations_left(int iterations, double gap, double tolerance) {
  return iterations * (std::sqrt(gap / tolerance) - 1);
}

StepSizes steps_of(double sigma) { return {static_cast<float>(sigma), static_cast<float>(step_product / sigma)}; }

}  // namespace

PrimalDualReport solve_primal_dual(Level& level, const PrimalDualParams& params, const Parallel& parallel,
                                   Progress& progress,
                                   const std::function<void(int iterations, const Energies&)>& observe) {
  const double sigma = params.step_balance * level.lambda;
  Sweeper sweeper(level, parallel);
  PrimalDualReport report;
  bool late = false;
  int check_after = (params.check_every + 1) / 2;
  while (report.iterations < params.max_iterations && !report.converged) {
    const int sweeps = std::min(check_after, params.max_iterations - report.iterations);
    for (int done = 0; done < sweeps; done += Sweeper::tile_sweeps) {
      progress.check();
      sweeper.sweep(steps_of(late ? late_balance * sigma : sigma), std::min(Sweeper::tile_sweeps, sweeps - done));
    }
    report.iterations += sweeps;
    report.energies = evaluate_energy(level, {}, parallel);
    const double gap = report.energies.relative_gap_band(level.lambda);
    report.converged = gap <= params.tolerance;
    late = late || gap <= late_gap * params.tolerance;
    const double left = (late ? late_iterations : 1) * iterations_left(report.iterations, gap, params.tolerance);
    check_after = left < params.check_every ? std::max(1, static_cast<int>(std::ceil(left))) : params.check_every;
    if (observe) observe(report.iterations, report.energies);
  }
  return report;
}

}  // namespace soapfilm
