#include "soapfilm/lambda/cross_validation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/field/sampling.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/lambda/coarse_problem.h"
#include "soapfilm/solve/energy.h"

namespace soapfilm {

namespace {

constexpr float threshold = 0.5f;
/// <f, u> of the thresholded u: what the samples of f gain through the surface.
double flux_through(const Level& level, const SupportField& field, const Context& context) {
  std::vector<double> sums(field.grid.size());
  parallel_for(context, sums.size(), 64, [&](size_t b) {
    const Vec3i brick = field.grid.coord(b);
    const int32_t n = level.grid.find(brick);
    const float* u = n >= 0 ? level.u.brick(static_cast<size_t>(n)) : nullptr;
    const bool inside = level.inside.test(level.grid, brick);
    const float* f = field.f.brick(b);
    for (int i = 0; i < brick_volume; ++i)
      if (u ? u[i] > threshold : inside) sums[b] += f[i];
  });
  return ordered_sum(field.grid, sums);
}

/// The held-out flux of one candidate; absent when the optimum is empty.
std::optional<double> held_out_flux(const Lattice& lattice, const FoldFields& fold, double lambda,
                                    const PrimalDualParams& solver, const Context& context) {
  const PyramidSolution solution = solve_coarse(lattice, fold.training, lambda, solver, context);
  const Energies energies = evaluate_energy(solution.finest, {.threshold = threshold, .certify = false}, context);
  if (!(energies.primal < 0)) return {};
  return flux_through(solution.finest, fold.held_out, context);
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double standard_error_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const auto n = static_cast<double>(values.size());
  return std::sqrt(squares / ((n - 1) * n));
}

}  // namespace

void validate(const CrossValidationParams& params) {
  if (params.max_resolution < 32 || params.max_resolution > 512)
    throw ParameterError(fmt::format("max_resolution = {}, must be between 32 and 512", params.max_resolution));
  if (!(params.indifference >= 0 && params.indifference < 1))
    throw ParameterError(fmt::format("indifference = {:g}, must be in [0, 1)", params.indifference));
  if (params.candidates.empty()) throw ParameterError("candidates: none given, must be at least 1");
  double last = 0;
  for (const double candidate : params.candidates) {
    if (!(candidate > last) || !std::isfinite(candidate))
      throw ParameterError(fmt::format("candidates: {:g} after {:g}, must be > 0 and increasing", candidate, last));
    last = candidate;
  }
}

std::vector<CrossValidationPoint> error_curve(std::span<const double> candidates,
                                              const std::vector<std::vector<double>>& flux) {
  std::vector<CrossValidationPoint> curve;
  for (size_t c = 0; c < candidates.size(); ++c) {
    std::vector<double> errors;
    for (size_t k = 0; k < flux[c].size(); ++k) {
      double best = 0;
      for (const std::vector<double>& other : flux) best = std::max(best, other[k]);
      errors.push_back(flux[c][k] > 0 ? 1 - flux[c][k] / best : 1);
    }
    curve.push_back(
        {.lambda_per_density = candidates[c], .error = mean_of(errors), .standard_error = standard_error_of(errors)});
  }
  return curve;
}

size_t least_error(const std::vector<CrossValidationPoint>& curve) {
  size_t best = 0;
  for (size_t c = 1; c < curve.size(); ++c)
    if (curve[c].error <= curve[best].error) best = c;
  return best;
}

size_t one_standard_error(const std::vector<CrossValidationPoint>& curve, double indifference) {
  const size_t best = least_error(curve);
  const double allowed = curve[best].error + std::max(curve[best].standard_error, indifference);
  size_t chosen = best;
  for (size_t c = best; c < curve.size(); ++c)
    if (curve[c].error <= allowed) chosen = c;
  return chosen;
}

CrossValidationReport choose_lambda(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& finest,
                                    const CrossValidationParams& params, const PrimalDualParams& solver,
                                    const Context& context) {
  validate(params);
  const Folds folds = make_folds(cloud, directions, params.folds, params.source, params.seed);
  const Lattice lattice = coarse_lattice(cloud, finest, params.max_resolution, context);
  const Sampling sampling = measure_sampling(cloud, context);
  const double density = sampling.density(lattice.voxel);

  const size_t count = params.candidates.size();
  std::vector<std::vector<double>> flux(count, std::vector<double>(static_cast<size_t>(folds.count), 0.0));
  std::vector<int> empty_folds(count, 0);
  for (int k = 0; k < folds.count; ++k) {
    const FoldFields fold = hold_out(cloud, directions, folds, k, lattice, context);
    bool empty = false;
    for (size_t c = 0; c < count; ++c) {
      context.check();
      const double done = (k + static_cast<double>(c) / static_cast<double>(count)) / folds.count;
      context.progress().advance(
          done, fmt::format("fold {} of {}, lambda {:g} per density", k + 1, folds.count, params.candidates[c]));
      // E(u) grows with lambda for every u: once the empty surface wins, it wins for all larger ones.
      const double lambda = params.candidates[c] * density * fold.training_share;
      const auto found = empty ? std::nullopt : held_out_flux(lattice, fold, lambda, solver, context);
      empty = !found;
      empty_folds[c] += empty;
      flux[c][static_cast<size_t>(k)] = found.value_or(0);
    }
  }

  CrossValidationReport report;
  report.folds = folds.count;
  report.whole_scans = folds.whole_scans;
  report.grid = lattice.to_world_axes(lattice.size);
  report.voxel = lattice.voxel;
  report.indifference = params.indifference;
  report.curve = error_curve(params.candidates, flux);
  for (size_t c = 0; c < count; ++c) {
    report.curve[c].lambda = params.candidates[c] * sampling.density(finest.voxel);
    report.curve[c].empty_folds = empty_folds[c];
  }
  const size_t best = least_error(report.curve);
  if (report.curve[best].error >= 1)
    throw ParameterError(fmt::format("candidates: {:g} to {:g}, none keeps a surface in any of {} folds",
                                     params.candidates.front(), params.candidates.back(), folds.count));
  report.best = params.candidates[best];
  report.chosen = params.candidates[one_standard_error(report.curve, params.indifference)];
  return report;
}

}  // namespace soapfilm
