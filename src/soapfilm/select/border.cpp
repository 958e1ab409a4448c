#include "soapfilm/select/border.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/error.h"
#include "soapfilm/pyramid/restrict.h"

namespace soapfilm {

namespace {

/// A coarse level is looked at as a problem of its own: roughly.
constexpr double trial_tolerance = 3e-3;
constexpr int trial_iterations = 400;

/// A level of the lattice as the finest of its own pyramid: the same lattice coordinates and boxes of bricks.
Lattice coarse_pyramid(const Lattice& lattice, int level) {
  Lattice coarse = lattice.of_level(level);
  for (int axis = 0; axis < 3; ++axis) coarse.size[axis] = ((lattice.size[axis] - 2) >> level) + 2;
  return coarse;
}

/// The energy problem of one coarse level.
struct Trial {
  Lattice lattice;
  SupportField field;
  double lambda;
};

Trial trial_of(const Lattice& lattice, const SupportField& field, double lambda, int level, const Parallel& parallel) {
  SupportField coarse = std::move(coarser_fields(field, lattice, level + 1, parallel).back());
  return {coarse_pyramid(lattice, level), std::move(coarse), std::ldexp(lambda, 2 * level)};
}

PyramidSolution solve(const Trial& trial, PrimalDualParams solver, Norm norm, const Parallel& parallel,
                      Progress& progress) {
  solver.tolerance = std::max(solver.tolerance, trial_tolerance);
  solver.max_iterations = std::min(solver.max_iterations, trial_iterations);
  PyramidSolution solution =
      solve_coarse_to_fine(trial.lattice, trial.field, trial.lambda, solver, parallel, progress, norm);
  progress.check();
  return solution;
}

/// E(0) = 0 competes.
double energy_of(const PyramidSolution& solution) { return std::min(0.0, solution.reports.back().energies.primal); }

/// The sum of |p| over the faces between free and fixed vertices of the band.
double border_flux(const Level& level) {
  double sum = 0;
  for (size_t b = 0; b < level.grid.size(); ++b) {
    const Vec3i coord = level.grid.coord(b);
    if (!at_border(level.box, coord)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const float* p = level.p.brick(b, axis);
      for (int i = 0; i < brick_volume; ++i) {
        const Vec3i v = coord * brick_side + Vec3i{i % brick_side, i / brick_side % brick_side, i / brick_area};
        Vec3i next = v;
        ++next[axis];
        if (level.box.is_free(v) != level.box.is_free(next)) sum += std::abs(double{p[i]});
      }
    }
  }
  return sum;
}

/// The lower of the closed ones, unless the open one gains enough over it.
void decide(double scale, double open_gain, BorderReport& report) {
  constexpr double tie = 0.01;  // of the scale: solved no better than that
  const auto percent = [&](double lower, double higher) { return 100 * (higher - lower) / scale; };
  report.chosen = *report.solid < *report.air - tie * scale ? Border::solid : Border::air;
  const bool solid = report.chosen == Border::solid;
  const double closed = solid ? *report.solid : *report.air, other = solid ? *report.air : *report.solid;
  if (*report.open < closed - open_gain * std::max(std::abs(closed), scale)) {
    report.chosen = Border::open;
    report.reason =
        fmt::format("a surface that ends at the box serves the samples better by {:.2g} % than a closed one",
                    percent(*report.open, closed));
    return;
  }
  report.reason =
      fmt::format("which serves the samples better by {:.2g} % than {} there, and an open surface by {:.2g} %",
                  percent(closed, other), solid ? "air" : "solid matter", std::max(0.0, percent(*report.open, closed)));
}

}  // namespace

void validate(const BorderParams& params) {
  if (!(params.open_gain > 0 && params.open_gain <= 1))
    throw ParameterError(fmt::format("open_gain = {:g}, must be > 0 and <= 1", params.open_gain));
}

void negate(SupportField& field, const Parallel& parallel) {
  parallel.for_each(field.grid.size(), 256, [&](size_t b) {
    float* f = field.f.brick(b);
    for (int i = 0; i < brick_volume; ++i) f[i] = -f[i];
  });
}

BorderReport choose_border(const Lattice& lattice, const SupportField& field, double lambda, const BorderParams& params,
                           const PrimalDualParams& solver, Norm norm, const Parallel& parallel, Progress& progress) {
  BorderReport report;
  const double gain = params.open_gain;
  report.level = std::min(2, lattice.levels - 1);
  Trial trial = trial_of(lattice, field, lambda, report.level, parallel);
  const PyramidSolution air = solve(trial, solver, norm, parallel, progress);
  report.air = energy_of(air);
  const double scale = std::max(std::abs(*report.air), 1000 * trial.lambda);
  report.border_flux = border_flux(air.finest) / scale;
  if (report.border_flux < gain) {
    report.reason = fmt::format("another border could gain no more than {:.2g} %", 100 * report.border_flux);
    return report;
  }
  trial.lattice.open = true;
  report.open = energy_of(solve(trial, solver, norm, parallel, progress));
  trial.lattice.open = false;
  negate(trial.field, parallel);
  report.solid = energy_of(solve(trial, solver, norm, parallel, progress));
  decide(scale, gain, report);
  return report;
}

}  // namespace soapfilm
