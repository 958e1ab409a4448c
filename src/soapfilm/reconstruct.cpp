#include "soapfilm/reconstruct.h"

#include <fmt/core.h>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/place.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/pyramid/critical_lambda.h"
#include "soapfilm/refine/indicator.h"

namespace soapfilm {

namespace {

/// Whatever is true of the input and the grid before the solve.
void announce(const ReconstructReport& report, Progress& progress) {
  const Vec3i n = report.lattice.size;
  progress.info(fmt::format("grid {} x {} x {}, voxel {:.4g}, {:.2g} samples per voxel^2, lambda {:.3g}, memory {}",
                            n.x, n.y, n.z, report.lattice.voxel, report.input.density, report.certificate.lambda,
                            format_bytes(report.planned_bytes)));
  // orient() has shown its own.
  for (size_t i = report.input.directions.warnings.size(); i < report.warnings.size(); ++i)
    progress.warn(report.warnings[i]);
}

/// E(0) = 0 competes: a surface must have a lower energy, or the optimum is empty.
void require_surface(const ReconstructReport& report, const Lattice& lattice, const SupportField& field,
                     const Parallel& parallel, Progress& progress) {
  const double lambda = report.certificate.lambda;
  if (report.certificate.binary.primal < 0) return;
  const double largest = critical_lambda(lattice, field, lambda, parallel, progress);
  throw EmptyResult(fmt::format("empty result: with lambda = {:.4g} no surface pays for its area at {:.2g} samples per "
                                "voxel^2; the largest lambda that keeps a surface is about {:.3g}",
                                lambda, report.input.density, largest),
                    largest);
}

void warn_unconverged(ReconstructReport& report, Progress& progress) {
  for (const LevelReport& level : report.levels) {
    if (level.converged) continue;
    report.warnings.push_back(
        fmt::format("level {}: not converged after {} iterations (tolerance {:g}); the certificate "
                    "below holds all the same",
                    level.level, level.iterations, report.params.solve.tolerance));
    progress.warn(report.warnings.back());
  }
}

Certificate certify(const Level& level, double lambda, double threshold, const Parallel& parallel) {
  Certificate certificate;
  certificate.lambda = lambda;
  certificate.relaxed = evaluate_energy(level, {.threshold = {}, .certify = true}, parallel);
  certificate.binary = evaluate_energy(level, {.threshold = static_cast<float>(threshold), .certify = true}, parallel);
  return certificate;
}

}  // namespace

Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Parallel& parallel,
                           Progress& progress) {
  validate(params);
  check_samples(cloud);
  Stages stages(progress);
  Reconstruction result;
  ReconstructReport& report = result.report;
  report.params = params;

  // Each sample gets a weak outward direction: its normal, towards the scanner, or estimated.
  const auto directions =
      stages.run("orient", [&] { return orient(cloud, params.orient, parallel, progress, report.input.directions); });
  report.warnings = report.input.directions.warnings;

  // The grid: how fine, where, and what it will cost.
  const auto samples = stages.run("place", [&] { return place(cloud, directions, params, parallel, report); });
  const Lattice& lattice = report.lattice;
  const double lambda = report.certificate.lambda;
  announce(report, progress);

  // The data term f = div v (section 4.1).
  auto field = stages.run("field", [&] { return divergence_field(samples, lattice.box(0), parallel); });

  // The convex problem (4), coarse to fine, on a thin band.
  auto solution = stages.run(
      "solve", [&] { return solve_coarse_to_fine(lattice, field, lambda, params.solve, parallel, progress); });
  report.levels = std::move(solution.reports);
  warn_unconverged(report, progress);
  Level& level = solution.finest;

  // How far from the global optimum, at most.
  report.certificate =
      stages.run("certify", [&] { return certify(level, lambda, params.surface.threshold, parallel); });
  report.inside = count_inside(level, static_cast<float>(params.surface.threshold), parallel);
  require_surface(report, lattice, field, parallel, progress);
  progress.info(fmt::format("segmentation proved within {:.2g} % of the global optimum",
                            100 * report.certificate.relative_gap_binary()));
  level.p = {};
  field.f = {};

  // Threshold, smooth, isovalue (section 4.4).
  const auto surface = stages.run(
      "smooth", [&] { return smoothed_indicator(level, static_cast<float>(params.surface.threshold), parallel); });
  report.isovalue = params.surface.isovalue.value_or(mean_at_samples(surface, samples, parallel));

  // The level set as a closed, manifold mesh.
  result.mesh = stages.run("extract", [&] {
    return extract_isosurface(
        surface.grid, surface.value, [&](Vec3i brick) { return surface.missing_value(brick); },
        static_cast<float>(report.isovalue), lattice, parallel);
  });
  if (result.mesh.triangles.empty())
    throw EmptyResult(
        fmt::format("empty result: the smoothed indicator stays on one side of the isovalue {:.3g}; parts "
                    "thinner than two voxels need a smaller voxel than {:.4g}",
                    report.isovalue, lattice.voxel),
        lambda);

  report.mesh_vertices = result.mesh.vertices.size();
  report.mesh_triangles = result.mesh.triangles.size();
  report.seconds = stages.seconds();
  report.peak_bytes = peak_memory_bytes();
  return result;
}

void check_result(Reconstruction& result, const PointCloud& cloud, const Parallel& parallel) {
  result.report.topology = check_topology(result.mesh);
  result.report.sample_distance = point_to_mesh_distance(cloud.positions, result.mesh, parallel);
}

}  // namespace soapfilm
