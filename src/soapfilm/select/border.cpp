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

PyramidSolution solve(const Trial& trial, PrimalDualParams solver, Norm norm, const Parallel& parallel) {
  solver.tolerance = std::max(solver.tolerance, trial_tolerance);
  solver.max_iterations = std::min(solver.max_iterations, trial_iterations);
  Progress unseen;
  return solve_coarse_to_fine(trial.lattice, trial.field, trial.lambda, solver, parallel, unseen, norm);
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
                           const PrimalDualParams& solver, Norm norm, const Parallel& parallel) {
  BorderReport report;
  report.level = std::min(2, lattice.levels - 1);
  Trial trial = trial_of(lattice, field, lambda, report.level, parallel);
  const PyramidSolution air = solve(trial, solver, norm, parallel);
  report.air = energy_of(air);
  report.border_flux = border_flux(air.finest) / std::abs(*report.air);
  trial.lattice.open = true;
  report.open = energy_of(solve(trial, solver, norm, parallel));
  trial.lattice.open = false;
  negate(trial.field, parallel);
  report.solid = energy_of(solve(trial, solver, norm, parallel));
  const double closed = std::min(*report.air, *report.solid);
  report.chosen = *report.open < (1 + params.open_gain) * closed ? Border::open
                  : *report.solid < *report.air                  ? Border::solid
                                                                 : Border::air;
  return report;
}

}  // namespace soapfilm
