// Evaluates all solvers: primal energy, dual energy and the gap between them, in double, from stored floats.
//
//   E(u) = lambda TV(u) - <f, u>                       for 0 <= u <= 1, u = 0 at fixed vertices       (equation (4))
//   D(p) = sum over free vertices of min(0, (grad^T p) - f)                for |p_x| <= lambda at every vertex
//
// |.| is the level's norm and its dual.
//
// E(u) >= E* >= D(p) for every such u and p on the whole domain, so E(u) - D(p) bounds the distance to the optimum.
#pragma once

#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

struct EnergyOptions {
  /// Evaluate the thresholded u (1 where u > mu) instead of the relaxed one.
  std::optional<float> threshold;
  /// Rescale p by 1 / max(1, max |p| / lambda) first, so that D is a valid bound in spite of rounding in the solver.
  bool certify = false;
};

/// Energies of a level's state.
Energies evaluate_energy(const Level& level, const EnergyOptions& options, const Context& context);

/// Where the gap of evaluate_energy() is: each vertex's part, in units of lambda, >= 0 but for rounding. Left out is
/// what lies outside of the band. With `certify`, `max_dual_norm` is that of evaluate_energy(), and p is rescaled by
/// it.
Field<float> local_gap(const Level& level, const EnergyOptions& options, double max_dual_norm, const Context& context);

/// An estimate of relative_gap_band() from every seventh brick: shows a solver when to evaluate all of them.
double estimate_gap(const Level& level, const Context& context);

}  // namespace soapfilm
