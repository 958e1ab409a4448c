#include "soapfilm/run/certify.h"

#include <fmt/core.h>

#include "soapfilm/core/method.h"
#include "soapfilm/core/names.h"
#include "soapfilm/pyramid/critical_lambda.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/solve/level_slabs.h"

namespace soapfilm {

namespace {

Certificate judge(const Segmentation& found, double lambda, double threshold, const Context& context) {
  const Level& level = found.level;
  const auto mu = static_cast<float>(threshold);
  Certificate certificate;
  certificate.lambda = lambda;
  // tv's solver last evaluated this same state, and that is a proof if rounding left no p outside of its ball.
  const std::vector<LevelReport>& levels = found.report.levels;
  const bool proved = !levels.empty() && levels.back().energies.max_dual_norm <= 1;
  certificate.relaxed =
      proved ? levels.back().energies : evaluate_energy(level, {.threshold = {}, .certify = true}, context);
  certificate.binary = evaluate_energy(level, {.threshold = mu, .certify = true}, context);
  certificate.inside = count_inside(level, bits_above(level, mu, context));
  return certificate;
}

}  // namespace

Certificate certify(const Segmentation& found, const Grid& grid, const SupportField& field, double lambda,
                    const ReconstructParams& params, const Context& context) {
  const Certificate certificate = judge(found, lambda, params.surface.threshold, context);
  // A surface must have a lower energy than E(0) = 0, or the optimum is empty. (A cut was compared with 0 in its own
  // energy, and poisson's surface does not depend on lambda: these only have to exist.)
  if (is_certified(params.method) ? certificate.binary.primal < 0 : certificate.inside > 0) return certificate;
  const double largest = critical_lambda(grid.lattice, field, lambda, context, params.energy.norm);
  if (largest > lambda)
    throw EmptyResult(
        fmt::format("empty result: method {} found no surface with lambda = {:.4g}, although one pays for "
                    "its area up to about {:.3g}: a smaller lambda may help, or {}",
                    name_of(params.method), lambda, largest,
                    params.method == Method::tv ? "more iterations" : "method tv"),
        largest);
  throw EmptyResult(fmt::format("empty result: with lambda = {:.4g} no surface pays for its area at {:.2g} samples per "
                                "voxel^2; the largest lambda that keeps a surface is about {:.3g}",
                                lambda, grid.density, largest),
                    largest);
}

std::optional<GapField> find_gap(const Level& level, const Certificate& certificate, const ReconstructParams& params,
                                 const Context& context) {
  if (!params.surface.gap) return std::nullopt;
  const auto mu = static_cast<float>(params.surface.threshold);
  return GapField{level.grid,
                  local_gap(level, {.threshold = mu, .certify = true}, certificate.binary.max_dual_norm, context),
                  LabelView(level, bits_above(level, mu, context)).interfaces(context)};
}

VolumeInterval volumes_near(Level& level, const Certificate& certificate, const ReconstructParams& params,
                            const Context& context) {
  complete(level);
  return find_volume_interval(
      level,
      {static_cast<float>(params.surface.threshold), certificate.relaxed.primal, *params.surface.volume_interval},
      params.solve, context);
}

}  // namespace soapfilm
