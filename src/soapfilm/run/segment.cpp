#include "soapfilm/run/segment.h"

#include <fmt/core.h>

#include "soapfilm/core/method.h"
#include "soapfilm/error.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/pyramid/sor_pyramid.h"
#include "soapfilm/solve/dense_level.h"
#include "soapfilm/solve/poisson.h"
#include "soapfilm/surface/dense_surface.h"

namespace soapfilm {

namespace {

/// The stage's arguments.
struct Task {
  const Lattice& lattice;
  const SupportField& field;
  double lambda;
  const ReconstructParams& params;
  const Context& context;
};

Segmentation by_tv(const Task& t, const PyramidObserver& observe) {
  PyramidSolution solution =
      solve_coarse_to_fine(t.lattice, t.field, t.lambda, t.params.solve, t.context, t.params.energy.norm, observe);
  Segmentation found;
  found.level = std::move(solution.finest);
  found.report.levels = std::move(solution.reports);
  return found;
}

Segmentation by_sor(const Task& t) {
  Segmentation found;
  found.level = solve_sor(t.lattice, t.field, t.lambda, t.params.sor, t.context, found.report.sor);
  return found;
}

Segmentation by_graph_cut(const Task& t, const PyramidObserver& observe) {
  Segmentation found;
  found.level = solve_graph_cut(t.lattice, t.field, t.lambda, graph_cut_setup(t.params), t.context,
                                found.report.graph_cut.emplace(), observe.cuts);
  return found;
}

Segmentation by_poisson(const Task& t, const GridSamples& samples) {
  const LevelBox box = t.lattice.box(0);
  Segmentation found;
  const DenseField<float> u =
      solve_poisson(t.lattice, t.field, t.lambda, t.params.poisson, t.context, found.report.poisson.emplace());
  const double isovalue = mean_at_samples(u, samples, t.context);
  if (!(isovalue > 0))
    throw ParameterError(
        fmt::format("poisson: the mean of u at the samples is {:.3g}, must be > 0 as it is where most "
                    "directions point outward",
                    isovalue));
  DenseSurface surface = dense_surface(u, isovalue, box, t.context);
  found.level = level_of(surface.binary, box, static_cast<float>(t.lambda), t.field.grid, t.field.f, t.context);
  found.surface = std::move(surface.field);
  return found;
}

}  // namespace

GraphCutSetup graph_cut_setup(const ReconstructParams& params) {
  return {neighbors_of_cut(params.method), params.graph_cut.weights, params.energy.norm};
}

Segmentation segment(const Lattice& lattice, const SupportField& field, const GridSamples& samples, double lambda,
                     const ReconstructParams& params, const PyramidObserver& observe, const Context& context) {
  const Task task{lattice, field, lambda, params, context};
  switch (params.method) {
    case Method::tv:
      return by_tv(task, observe);
    case Method::tv_sor:
      return by_sor(task);
    case Method::poisson:
      return by_poisson(task, samples);
    case Method::graph_cut_6:
    case Method::graph_cut_26:
      return by_graph_cut(task, observe);
    case Method::vrip:
      break;
  }
  throw ParameterError("method = vrip, must be one that segments the grid");
}

}  // namespace soapfilm
