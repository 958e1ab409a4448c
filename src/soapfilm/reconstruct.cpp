#include "soapfilm/reconstruct.h"

#include <fmt/core.h>

#include <optional>

#include "soapfilm/announce.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/core/zeroed_memory.h"
#include "soapfilm/extract/bend.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/finish/islands.h"
#include "soapfilm/place.h"
#include "soapfilm/pyramid/critical_lambda.h"
#include "soapfilm/segment.h"

namespace soapfilm {

namespace {

/// E(0) = 0 competes: a surface must have a lower energy, or the optimum is empty. (A cut has done so in its own
/// energy, poisson's surface owes nothing to lambda: theirs only has to be there.)
void require_surface(const ReconstructReport& report, const Lattice& lattice, const SupportField& field,
                     const Parallel& parallel, Progress& progress) {
  const double lambda = report.certificate.lambda;
  const bool kept = is_certified(report.params.method) ? report.certificate.binary.primal < 0 : report.inside > 0;
  if (kept) return;
  const double largest = critical_lambda(lattice, field, lambda, parallel, progress, report.params.energy.norm);
  if (largest > lambda)
    throw EmptyResult(
        fmt::format("empty result: method {} found no surface with lambda = {:.4g}, although one pays for "
                    "its area up to about {:.3g}: a smaller lambda may help, or {}",
                    name_of(report.params.method), lambda, largest,
                    report.params.method == Method::tv ? "more iterations" : "method tv"),
        largest);
  throw EmptyResult(fmt::format("empty result: with lambda = {:.4g} no surface pays for its area at {:.2g} samples per "
                                "voxel^2; the largest lambda that keeps a surface is about {:.3g}",
                                lambda, report.input.density, largest),
                    largest);
}

void certify(const Level& level, double threshold, const Parallel& parallel, ReconstructReport& report) {
  const auto mu = static_cast<float>(threshold);
  // What tv's solver saw last is this state, and a proof where no rounding left p outside of its ball.
  const bool proved = !report.levels.empty() && report.levels.back().energies.max_dual_norm <= 1;
  report.certificate.relaxed =
      proved ? report.levels.back().energies : evaluate_energy(level, {.threshold = {}, .certify = true}, parallel);
  report.certificate.binary = evaluate_energy(level, {.threshold = mu, .certify = true}, parallel);
  report.inside = count_inside(level, mu, parallel);
}

/// The field whose level set at report.isovalue is the surface: sub-voxel accurate, or the paper's (section 4.4).
SurfaceField level_set(Segmentation& found, const GridSamples& samples, const ReconstructParams& params,
                       const Parallel& parallel, ReconstructReport& report) {
  const auto threshold = static_cast<float>(params.surface.threshold);
  if (found.surface) {
    report.isovalue = 0.5;
    return std::move(*found.surface);
  }
  if (refines(params)) {
    RefineParams how = params.refine;
    how.vanish = drops_islands(params);
    return refine(std::move(found.level), threshold, samples, report.input.density, how, parallel,
                  report.refine.emplace());
  }
  SurfaceField surface = smoothed_indicator(found.level, threshold, parallel);
  report.isovalue = params.surface.isovalue ? *params.surface.isovalue : mean_at_samples(surface, samples, parallel);
  return surface;
}

Mesh closed_mesh(const SurfaceField& surface, const Lattice& lattice, const Parallel& parallel,
                 const ReconstructReport& report) {
  Mesh mesh = extract_isosurface(
      surface.grid, surface.value, [&](Vec3i brick) { return surface.missing_value(brick); },
      static_cast<float>(report.isovalue), lattice, parallel);
  if (mesh.triangles.empty())
    throw EmptyResult(
        fmt::format("empty result: the smoothed indicator stays on one side of the isovalue {:.3g}; parts "
                    "thinner than two voxels need a smaller voxel than {:.4g}",
                    report.isovalue, lattice.voxel),
        report.certificate.lambda);
  return mesh;
}

/// Curless and Levoy's surface needs neither the field nor the solve: its scans say what is known.
Mesh fused_surface(const PointCloud& cloud, const Lattice& lattice, const ReconstructParams& params, Stages& stages,
                   const Parallel& parallel, Progress& progress, ReconstructReport& report) {
  const FusedField fused = stages.run(
      "fuse", [&] { return fuse_scans(cloud, lattice, params.vrip, parallel, progress, report.vrip.emplace()); });
  Mesh mesh = stages.run("extract", [&] {
    return extract_open_isosurface(fused.grid, fused.distance, fused.weight, 0, lattice, parallel);
  });
  if (mesh.triangles.empty())
    throw EmptyResult(fmt::format("empty result: the scans saw both sides of their surfaces in no whole cell; a grid "
                                  "nearer to their own spacing than voxel {:.4g} may",
                                  lattice.voxel),
                      0);
  return mesh;
}

/// `owned`: the cloud, when it may be freed.
Reconstruction reconstruct(const PointCloud& cloud, PointCloud* owned, const ReconstructParams& params,
                           const Parallel& parallel, Progress& progress, const PyramidObserver& observe) {
  validate(params);
  const Box3d box = check_samples(cloud, parallel);
  if (params.method == Method::vrip)
    for (const Scan& scan : cloud.scans) require_range_scan(scan);
  Stages stages(progress);
  Reconstruction result;
  ReconstructReport& report = result.report;
  report.params = params;
  const auto finish = [&](Mesh mesh) {
    result.mesh = std::move(mesh);
    report.mesh_vertices = result.mesh.vertices.size();
    report.mesh_triangles = result.mesh.triangles.size();
    report.stages = stages.times();
    report.peak_bytes = peak_memory_bytes();
    return std::move(result);
  };

  // Each sample gets a weak outward direction: its normal, towards the scanner, or estimated.
  auto directions =
      stages.run("orient", [&] { return orient(cloud, params.orient, parallel, progress, report.input.directions); });
  report.warnings = report.input.directions.warnings;

  // The grid: how fine, where, and what it will cost; and what area weighs on it.
  const auto after = owned ? AfterPlacing::freed : AfterPlacing::kept;
  auto samples = stages.run("place", [&] { return place(cloud, box, directions, params, after, parallel, report); });
  const Lattice& lattice = report.lattice;
  stages.run("weigh", [&] { weigh_area(cloud, directions, params, parallel, progress, samples, report); });
  announce_grid(report, progress);
  if (params.method == Method::vrip)
    return finish(fused_surface(cloud, lattice, params, stages, parallel, progress, report));
  release(directions);
  release(samples.source);
  if (owned) *owned = {};

  // The data term f = div v (section 4.1).
  auto field = stages.run("field", [&] { return divergence_field(samples, lattice.box(0), parallel); });

  // The refinement's arrays take the place of the solve's, and the mesh theirs.
  std::optional<KeepFreedPages> keep(std::in_place);

  // Inside or outside: the convex problem (4), coarse to fine, on a thin band; or what it is compared with.
  auto segmentation = stages.run(
      "solve", [&] { return segment(lattice, field, samples, params, observe, parallel, progress, report); });
  warn_unconverged(report, progress);
  Level& level = segmentation.level;

  // How far from the global optimum, at most.
  stages.run("certify", [&] { certify(level, params.surface.threshold, parallel, report); });
  require_surface(report, lattice, field, parallel, progress);
  announce_energy(report, progress);
  level.p = {};
  field.f = {};

  // Specks and bubbles that hardly a sample vouches for, such as outliers leave, go. (The certificate speaks of the
  // solution with them.)
  if (drops_islands(params))
    stages.run("finish", [&] {
      drop_islands(level, static_cast<float>(params.surface.threshold), samples, report.input.density, params.islands,
                   parallel, report.islands.emplace());
    });
  announce_islands(report, progress);

  // The level set moves onto the samples; components and genus stay those of the segmentation, but for what it leaves
  // nothing of.
  const auto surface = stages.run("refine", [&] { return level_set(segmentation, samples, params, parallel, report); });
  announce_vanished(report, progress);

  // The level set as a closed, manifold mesh.
  Mesh mesh = stages.run("extract", [&] { return closed_mesh(surface, lattice, parallel, report); });
  keep.reset();

  // Where the surface bends, triangles of a voxel are too coarse for what the samples tell.
  if (report.refine && params.surface.bend.tolerance > 0 && !report.refine->strength.yield)
    stages.run("bend", [&] {
      const double scale = std::max(params.refine.robust.least_scale,
                                    params.refine.robust.scale_of_noise * report.refine->strength.noise);
      bend_edges(mesh, SmoothField(surface.grid, surface.value, parallel), samples, scale, lattice, params.surface.bend,
                 parallel, report.bend.emplace());
    });
  return finish(std::move(mesh));
}

}  // namespace

Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Parallel& parallel,
                           Progress& progress, const PyramidObserver& observe) {
  return reconstruct(cloud, nullptr, params, parallel, progress, observe);
}

Reconstruction reconstruct(PointCloud&& cloud, const ReconstructParams& params, const Parallel& parallel,
                           Progress& progress, const PyramidObserver& observe) {
  PointCloud owned = std::move(cloud);
  return reconstruct(owned, &owned, params, parallel, progress, observe);
}

void check_result(Reconstruction& result, const PointCloud& cloud, const Parallel& parallel) {
  result.report.topology = check_topology(result.mesh);
  result.report.sample_distance = point_to_mesh_distance(cloud.positions, result.mesh, parallel);
}

}  // namespace soapfilm
