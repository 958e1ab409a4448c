#include "soapfilm/solve/primal_dual.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "soapfilm/solve/level_solver.h"

namespace soapfilm {

namespace {

/// When the gap reaches this multiple of the tolerance, sigma is halved and tau doubled: what remains is mostly u still
/// moving between 0 and 1 where data is sparse, while p has settled.
constexpr double late_gap = 10;
constexpr double late_balance = 0.5;

/// With fewer bricks, a few would not be representative, and evaluating all is fast.
constexpr size_t least_bricks_to_estimate = 4096;
/// At every so many checks all bricks are evaluated, whatever the estimates are.
constexpr int most_estimates = 4;

/// Predicts the number of iterations left.
class Forecast {
 public:
  explicit Forecast(double tolerance) : tolerance_(tolerance) {}

  /// Call after each evaluation of the gap, of all bricks or of some. The gap falls about as 1 / iterations^2, somewhat
  /// faster when late; between two late evaluations of one kind the power is taken from these.
  double left(int iterations, double gap, bool late, bool whole) {
    constexpr double late_share = 0.7;
    const double left = late && iterations_ > 0 && whole == whole_
                            ? until(iterations, gap, power_since(iterations, gap))
                            : (late ? late_share : 1) * until(iterations, gap, 2);
    if (late) {
      iterations_ = iterations;
      gap_ = gap;
      whole_ = whole;
    }
    return left;
  }

 private:
  /// 1, 2 or 4: the gap has fallen at least as 1 / iterations^power. (Only roots and
  /// products, for the same bits on every machine.)
  int power_since(int iterations, double gap) const {
    const double longer = static_cast<double>(iterations) / iterations_, squared = longer * longer;
    return gap * squared * squared <= gap_ ? 4 : gap * squared <= gap_ ? 2 : 1;
  }
  /// If the gap falls as 1 / iterations^power.
  double until(int iterations, double gap, int power) const {
    double longer = gap / tolerance_;
    for (; power > 1; power /= 2) longer = std::sqrt(longer);
    return iterations * (longer - 1);
  }

  double tolerance_;
  int iterations_ = 0;  ///< at the last late evaluation, 0: none yet
  double gap_ = 0;
  bool whole_ = false;
};

}  // namespace

PrimalDualReport solve_primal_dual(Level& level, const PrimalDualParams& params, const Context& context,
                                   const PrimalDualRun& run) {
  const double sigma = params.step_balance * level.lambda;
  const int estimates = run.evaluated || level.grid.size() < least_bricks_to_estimate ? 1 : most_estimates;
  const std::shared_ptr<LevelSolver> solver = level_solver(level, context);
  PrimalDualReport report;
  Forecast forecast(params.tolerance);
  Stall stall;
  Settling settling(level, context);
  const bool settles = run.settles && params.settle;
  bool late = run.late, ended = false;
  int check_after = (params.check_every + 1) / 2;
  for (int check = 1; report.iterations < params.max_iterations && !ended; ++check) {
    const int sweeps = std::min(check_after, params.max_iterations - report.iterations);
    for (int done = 0; done < sweeps; done += LevelSolver::sweeps_at_once) {
      context.check();
      solver->sweep(step_sizes(late ? late_balance * sigma : sigma),
                    std::min(LevelSolver::sweeps_at_once, sweeps - done));
    }
    report.iterations += sweeps;
    double gap = 0;
    bool whole = check % estimates == 0 || report.iterations == params.max_iterations;
    const auto stop = [&](Stop reason) {
      report.stop = reason;
      ended = true;
    };
    bool stalled = false;
    if (!whole) {
      gap = solver->estimated_gap();
      stalled = run.stalls && stall.found(report.iterations, gap, false);
      whole = stalled || gap <= params.tolerance || (settles && settling.due(report.iterations, gap, params.tolerance));
    }
    if (whole) {
      report.energies = solver->energies();
      gap = report.energies.relative_gap_band(level.lambda);
      report.converged = gap <= params.tolerance;
      solver->download();
      if (run.evaluated) run.evaluated(report.iterations, report.energies);
      if (report.converged)
        stop(Stop::converged);
      else if (settles && settling.due(report.iterations, gap, params.tolerance) &&
               settling.found(report.iterations, report.energies))
        stop(Stop::settled);
      else if (stalled || (run.stalls && stall.found(report.iterations, gap, true)))
        stop(Stop::stalled);
    }
    if (run.checked) run.checked(report.iterations, gap);
    late = late || gap <= late_gap * params.tolerance;
    const double left = forecast.left(report.iterations, gap, late, whole);
    check_after = left < params.check_every ? std::max(1, static_cast<int>(std::ceil(left))) : params.check_every;
  }
  solver->download();
  return report;
}

}  // namespace soapfilm
