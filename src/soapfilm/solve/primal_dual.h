// The certified solver of one level: primal-dual sweeps until the band's part of the gap is below the tolerance.
#pragma once

#include <functional>

#include "soapfilm/context.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/level.h"
#include "soapfilm/solve/profit.h"

namespace soapfilm {

struct PrimalDualReport {
  int iterations = 0;
  bool converged = false;
  Stop stop = Stop::limit;
  Energies energies;  ///< of the relaxed u
};

/// How a level is solved, in addition to the parameters.
struct PrimalDualRun {
  bool late = false;  ///< use the late step sizes from the start: p comes from a solved level and has settled
  /// It may end with Stop::stalled: it starts from a solved level. From zero the gap may stand still until waves have
  /// crossed the box.
  bool stalls = false;
  bool settles = false;  ///< and, if params.settle, with Stop::settled: the thresholded u is what matters
  std::function<void(int iterations, double gap)> checked = {};  ///< after each computation of the band's relative gap
  /// After each evaluation of the whole level. If empty, a large level's gap is estimated until it is close to the
  /// tolerance.
  std::function<void(int iterations, const Energies&)> evaluated = {};
};

/// Changes level.u and level.p.
PrimalDualReport solve_primal_dual(Level& level, const PrimalDualParams& params, const Context& context,
                                   const PrimalDualRun& run = {});

}  // namespace soapfilm
