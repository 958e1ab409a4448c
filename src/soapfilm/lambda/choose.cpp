#include "soapfilm/lambda/choose.h"

#include <fmt/core.h>

#include "soapfilm/error.h"
#include "soapfilm/field/sampling.h"

namespace soapfilm {

namespace {

/// The best value may lie beyond the end of the curve.
void warn_at_end(const CrossValidationReport& select, std::vector<std::string>& warnings) {
  const double lowest = select.curve.front().lambda_per_density, highest = select.curve.back().lambda_per_density;
  if (lowest == highest || (select.chosen != lowest && select.chosen != highest)) return;
  const bool low = select.chosen == lowest;
  warnings.push_back(
      fmt::format("cross-validation chose the {} of {} candidates, {:g} x samples per voxel^2: a {} one may be better",
                  low ? "lowest" : "highest", select.curve.size(), select.chosen, low ? "lower" : "higher"));
}

}  // namespace

Lambda choose(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& lattice, double density,
              const LambdaParams& params, const Context& context) {
  Lambda lambda;
  double per_density = params.energy.lambda_per_density;
  if (params.energy.cross_validate) {
    lambda.select = choose_lambda(cloud, directions, lattice, params.cross_validation, params.solver, context);
    per_density = lambda.select->chosen;
    // Converted to this grid by its density.
    for (CrossValidationPoint& point : lambda.select->curve) point.lambda = point.lambda_per_density * density;
    warn_at_end(*lambda.select, lambda.warnings);
  }
  lambda.value = params.energy.lambda.value_or(per_density * density);
  if (!(lambda.value > 0)) throw SamplesError("too few samples to measure their density by: lambda must be given");
  return lambda;
}

std::optional<std::string> near_empty(double lambda, double density) {
  const double edge = critical_density * density;
  if (3 * lambda <= edge) return {};
  return fmt::format(
      "lambda = {:.3g} is {} {:.3g}, above which a surface with {:.2g} samples per voxel^2 vanishes: expect "
      "missing parts (smaller --lambda, or coarser voxels)",
      lambda, lambda > edge ? "above" : "near", edge, density);
}

}  // namespace soapfilm
