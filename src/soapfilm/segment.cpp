#include "soapfilm/segment.h"

#include "soapfilm/refine/dense_surface.h"
#include "soapfilm/solve/dense_level.h"

namespace soapfilm {

namespace {

/// A stage's arguments in one hand.
struct Problem {
  const Lattice& lattice;
  const SupportField& field;
  double lambda;
  const ReconstructParams& params;
  const Parallel& parallel;
  Progress& progress;
};

Segmentation by_tv(const Problem& p, const PyramidObserver& observe, ReconstructReport& report) {
  PyramidSolution solution = solve_coarse_to_fine(p.lattice, p.field, p.lambda, p.params.energy.norm, p.params.solve,
                                                  p.parallel, p.progress, observe);
  report.levels = std::move(solution.reports);
  return {std::move(solution.finest), {}};
}

Segmentation by_sor(const Problem& p, ReconstructReport& report) {
  return {solve_sor(p.lattice, p.field, p.lambda, p.params.sor, p.parallel, p.progress, report.sor), {}};
}

Segmentation by_graph_cut(const Problem& p, int neighbors, ReconstructReport& report) {
  GraphCutParams params = p.params.graph_cut;
  params.neighbors = neighbors;
  params.norm = p.params.energy.norm;
  return {solve_graph_cut(p.lattice, p.field, p.lambda, params, p.parallel, p.progress, report.graph_cut.emplace()),
          {}};
}

Segmentation by_poisson(const Problem& p, const GridSamples& samples, ReconstructReport& report) {
  const DenseField<float> u =
      solve_poisson(p.lattice, p.field, p.lambda, p.params.poisson, p.parallel, p.progress, report.poisson.emplace());
  return {};
}

}  // namespace

}  // namespace soapfilm
