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
/// on its way between 0 and 1 where data is scarce, and p has settled.
constexpr double late_gap = 10;
constexpr double late_balance = 0.5;

/// Of fewer bricks a few would not tell the gap, and all of them are looked at soon.
constexpr size_t least_bricks_to_estimate = 4096;

/// Tells how many iterations are left.
class Forecast {
 public:
  explicit Forecast(double tolerance) : tolerance_(tolerance) {}

  /// After each evaluation. The gap falls about as 1 / iterations^2, when it gets late somewhat faster; between two
  /// late evaluations as they tell.
  double left(int iterations, double gap, bool late) {
    constexpr double late_share = 0.7;
    double left = (late ? late_share : 1) * until(iterations, gap, 2);
    if (late && iterations_ > 0 && gap < gap_)
      left = until(iterations, gap, std::log(gap_ / gap) / std::log(static_cast<double>(iterations) / iterations_));
    if (late) {
      iterations_ = iterations;
      gap_ = gap;
    }
    return left;
  }

 private:
  /// Where the gap falls as 1 / iterations^power.
  double until(int iterations, double gap, double power) const {
    return iterations * (std::pow(gap / tolerance_, 1 / power) - 1);
  }

  double tolerance_;
  int iterations_ = 0;  ///< at the last late evaluation, 0: there was none
  double gap_ = 0;
};

StepSizes steps_of(double sigma) { return {static_cast<float>(sigma), static_cast<float>(step_product / sigma)}; }

}  // namespace

PrimalDualReport solve_primal_dual(Level& level, const PrimalDualParams& params, const Parallel& parallel,
                                   Progress& progress,
                                   const std::function<void(int iterations, const Energies&)>& observe) {
  const double sigma = params.step_balance * level.lambda;
  Sweeper sweeper(level, parallel);
  PrimalDualReport report;
  Forecast forecast(params.tolerance);
  bool late = params.late;
  bool estimates = params.estimate && level.grid.size() >= least_bricks_to_estimate;
  int check_after = (params.check_every + 1) / 2;
  while (report.iterations < params.max_iterations && !report.converged) {
    const int sweeps = std::min(check_after, params.max_iterations - report.iterations);
    for (int done = 0; done < sweeps; done += Sweeper::tile_sweeps) {
      progress.check();
      sweeper.sweep(steps_of(late ? late_balance * sigma : sigma), std::min(Sweeper::tile_sweeps, sweeps - done));
    }
    report.iterations += sweeps;
    double gap = estimates ? estimate_gap(level, parallel) : 0;
    if (gap <= params.tolerance || report.iterations == params.max_iterations) {
      report.energies = evaluate_energy(level, {}, parallel);
      gap = report.energies.relative_gap_band(level.lambda);
      report.converged = gap <= params.tolerance;
      estimates = false;
      if (observe) observe(report.iterations, report.energies);
    }
    late = late || gap <= late_gap * params.tolerance;
    const double left = forecast.left(report.iterations, gap, late);
    check_after = left < params.check_every ? std::max(1, static_cast<int>(std::ceil(left))) : params.check_every;
  }
  return report;
}

}  // namespace soapfilm
