// Problems on a coarse grid that can be solved often and roughly.
#pragma once

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/pyramid/coarse_to_fine.h"

namespace soapfilm {

/// A lattice of at most `max_resolution` vertices along the cloud's longest axis, never finer than `finest`.
Lattice coarse_lattice(const PointCloud& cloud, const Lattice& finest, int max_resolution, const Context& context);

/// solve_coarse_to_fine() to a tolerance of 1e-3, or `solver`'s where that is larger, in at most 400 iterations per
/// level. Shows no progress.
PyramidSolution solve_coarse(const Lattice& lattice, const SupportField& field, double lambda, PrimalDualParams solver,
                             const Context& context);

}  // namespace soapfilm
