#pragma once

#include "soapfilm/pyramid/coarse_to_fine.h"

namespace soapfilm {

/// The largest lambda whose optimum is not empty, below `lambda`: max over sets of <f, u> / TV(u), found from below by
/// Dinkelbach's iteration (1967): the ratio of the optimum at one lambda is the next lambda. Accurate to a few percent;
/// every smaller lambda keeps a surface. 0 if none is found down to lambda / 4096.
double critical_lambda(const Lattice& lattice, const SupportField& support, double lambda, const Context& context,
                       Norm norm = Norm::isotropic);

}  // namespace soapfilm
