// The one judge of all solvers: primal energy, dual energy and the gap between them, in double, from stored floats.
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
  /// Judge the thresholded u (1 where u > mu) instead of the relaxed one.
  std::optional<float> threshold;
  /// Rescale p by 1 / max(1, max |p| / lambda) first, so that D is a proof in spite of rounding in the solver.
  bool certify = false;
};

/// Energies of a level's state.
Energies evaluate_energy(const Level& level, const EnergyOptions& options, const Context& context);

/// About relative_gap_band(), from every seventh brick: tells a solver when to look at all of them.
double estimate_gap(const Level& level, const Context& context);

}  // namespace soapfilm
