#include "soapfilm/lambda/coarse_problem.h"
#include "soapfilm/core/context_state.h"

#include <algorithm>

namespace soapfilm {

namespace {

/// Relevant errors are above 1e-3 of the flux; a tighter solve would not change them.
constexpr double coarse_tolerance = 1e-3;
constexpr int coarse_iterations = 400;

}  // namespace

Lattice coarse_lattice(const PointCloud& cloud, const Lattice& finest, int max_resolution, const Context& context) {
  const Box3d box = cloud.box(context);
  const int padding = std::min(finest.padding, max_resolution / 4);
  const double voxel = std::max(finest.voxel, voxel_of_resolution(box, max_resolution, padding));
  return place_lattice(box, voxel, padding);
}

PyramidSolution solve_coarse(const Lattice& lattice, const SupportField& field, double lambda, PrimalDualParams solver,
                             const Context& context) {
  solver.tolerance = std::max(solver.tolerance, coarse_tolerance);
  solver.max_iterations = std::min(solver.max_iterations, coarse_iterations);
  return solve_coarse_to_fine(lattice, field, lambda, solver, silenced(context));
}

}  // namespace soapfilm
