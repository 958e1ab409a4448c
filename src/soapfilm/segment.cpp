#include "soapfilm/segment.h"

#include <fmt/core.h>

#include "soapfilm/core/error.h"
#include "soapfilm/pyramid/sor_pyramid.h"
#include "soapfilm/refine/dense_surface.h"
#include "soapfilm/solve/dense_level.h"

namespace soapfilm {

namespace {

/// The stage's arguments in one hand.
struct Task {
  const Lattice& lattice;
  const SupportField& field;
  double lambda;
  const ReconstructParams& params;
  const Context& context;
};

Segmentation by_tv(const Task& t, const PyramidObserver& observe, ReconstructReport& report) {
  PyramidSolution solution =
      solve_coarse_to_fine(t.lattice, t.field, t.lambda, t.params.solve, t.context, t.params.energy.norm, observe);
  report.levels = std::move(solution.reports);
  return {std::move(solution.finest), {}};
}

Segmentation by_sor(const Task& t, ReconstructReport& report) {
  return {solve_sor(t.lattice, t.field, t.lambda, t.params.sor, t.context, report.sor), {}};
}

Segmentation by_graph_cut(const Task& t, int neighbors, ReconstructReport& report) {
  GraphCutParams params = t.params.graph_cut;
  params.neighbors = neighbors;
  params.norm = t.params.energy.norm;
  return {solve_graph_cut(t.lattice, t.field, t.lambda, params, t.context, report.graph_cut.emplace()), {}};
}

Segmentation by_poisson(const Task& t, const GridSamples& samples, ReconstructReport& report) {
  const LevelBox box = t.lattice.box(0);
  const DenseField<float> u =
      solve_poisson(t.lattice, t.field, t.lambda, t.params.poisson, t.context, report.poisson.emplace());
  report.isovalue = mean_at_samples(u, samples, t.context);
  if (!(report.isovalue > 0))
    throw ParameterError(
        fmt::format("poisson: the mean of u at the samples is {:.3g}, must be > 0 as it is where most "
                    "directions point outward",
                    report.isovalue));
  DenseSurface surface = dense_surface(u, report.isovalue, box, t.context);
  return {level_of(surface.binary, box, static_cast<float>(t.lambda), t.field.grid, t.field.f, t.context),
          std::move(surface.field)};
}

}  // namespace

Segmentation segment(const Lattice& lattice, const SupportField& field, const GridSamples& samples,
                     const ReconstructParams& params, const PyramidObserver& observe, const Context& context,
                     ReconstructReport& report) {
  const Task task{lattice, field, report.certificate.lambda, params, context};
  switch (params.method) {
    case Method::tv:
      return by_tv(task, observe, report);
    case Method::tv_sor:
      return by_sor(task, report);
    case Method::poisson:
      return by_poisson(task, samples, report);
    case Method::graph_cut_6:
      return by_graph_cut(task, 6, report);
    case Method::graph_cut_26:
      return by_graph_cut(task, 26, report);
    case Method::vrip:
      break;
  }
  throw ParameterError("method = vrip, must be one that segments the grid");
}

}  // namespace soapfilm
