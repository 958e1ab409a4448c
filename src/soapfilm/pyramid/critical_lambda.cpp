#include "soapfilm/pyramid/critical_lambda.h"

#include "soapfilm/solve/energy.h"

namespace soapfilm {

namespace {

/// <f, u> / TV(u) of the thresholded optimum at one lambda; 0 when that is empty.
double ratio_at(const Lattice& lattice, const SupportField& support, double lambda, const Context& context, Norm norm) {
  PrimalDualParams params;
  params.tolerance = 1e-3;
  params.max_iterations = 400;
  const PyramidSolution solution = solve_coarse_to_fine(lattice, support, lambda, params, context, norm);
  const Energies e = evaluate_energy(solution.finest, {.threshold = 0.5f, .certify = false}, context);
  return e.total_variation > 0 && e.primal < 0 ? e.data / e.total_variation : 0;
}

}  // namespace

double critical_lambda(const Lattice& lattice, const SupportField& support, double lambda, const Context& context,
                       Norm norm) {
  double largest = 0;
  for (int halvings = 0; halvings < 12 && largest == 0; ++halvings)
    largest = ratio_at(lattice, support, lambda *= 0.5, context, norm);
  // At that ratio itself the surface found so far gains nothing; a better one, if any, still gains just below it.
  for (int step = 0; step < 4 && largest > 0; ++step) {
    const double better = ratio_at(lattice, support, 0.99 * largest, context, norm);
    if (better <= 1.005 * largest) break;
    largest = better;
  }
  return 0.99 * largest;
}

}  // namespace soapfilm
