#include "soapfilm/run/surface.h"

#include <fmt/core.h>

#include <cstdint>
#include <utility>

#include "soapfilm/components/components.h"
#include "soapfilm/components/scanners.h"
#include "soapfilm/core/border_edges.h"
#include "soapfilm/core/names.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/finish/trim.h"
#include "soapfilm/fuse/vrip.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/relax/relax.h"
#include "soapfilm/run/announce.h"
#include "soapfilm/run/defaults.h"

namespace soapfilm {

std::optional<ComponentReport> drop_unsupported(Labels& labels, const GridSamples& samples, const Grid& grid,
                                                const ReconstructParams& params, Trace& trace, const Context& context) {
  if (!drops_components(params)) return {};
  // What was not seen of a part is cut off later, so less of it needs samples.
  constexpr double least_of_open = 0.1;
  ComponentSetup how{params.components, grid.lattice.open};
  if (grid.ends) how.min_support *= least_of_open;
  ComponentReport report;
  trace.stage("components", [&] { drop_components(labels, samples, grid.density, how, context, report); });
  announce_components(report, params, trace);
  return report;
}

ScannerReport stand_scanners(const Labels& labels, const Scanners& scanners, const Grid& grid,
                             const BorderReport& border) {
  std::vector<Vec3d> positions = scanners.positions;
  for (Vec3d& p : positions) p = grid.lattice.to_lattice(p);
  return place_scanners(labels, border.chosen == Border::solid, positions);
}

std::optional<RefineReport> summary_of(const Surface& surface) {
  if (!surface.refine) return {};
  const FitWeights& in_use = surface.refine->fit_weights;
  return RefineReport{in_use.smoothing, in_use.normals, in_use.noise, surface.refine->spacing};
}

RefineSetup refine_setup(const Grid& grid, const ReconstructParams& params, const RobustParams& robust) {
  RefineSetup how{params.refine, robust, drops_components(params), grid.lattice.open};
  if (grid.ends) how.holes = HoleFill::flat;  // most are no holes, but where the surface ends
  return how;
}

Surface find_surface(Labels labels, const GridSamples& samples, const Grid& grid, const ReconstructParams& params,
                     const RobustParams& robust, MemoryBudget& memory, const Context& context) {
  Surface surface;
  if (refines(params)) {
    const RefineSetup how = refine_setup(grid, params, robust);  // outlives the refinement
    Refinement refinement(std::move(labels), samples, grid.density, how, context, surface.refine.emplace());
    memory.plan_refinement(refinement.rows(), refinement.tries_coarser(), samples.size());
    surface.field = refinement.fit();
    surface.scale = robust.scale(surface.refine->fit_weights.noise);
    return surface;
  }
  IndicatorField field = smoothed_indicator(labels, context);
  surface.isovalue = params.surface.isovalue ? *params.surface.isovalue : mean_at_samples(field, samples, context);
  surface.field = std::move(field);
  return surface;
}

Mesh triangles_of(const Surface& surface, const Lattice& lattice, double lambda, const Context& context) {
  Mesh mesh = extract_isosurface(
      surface.values().grid, surface.values().value, [&](Vec3i brick) { return surface.missing_value(brick); },
      static_cast<float>(surface.isovalue), lattice, context, drawn_range(lattice.box(0)));
  if (mesh.triangles.empty() && surface.refine)
    throw EmptyResult(fmt::format("empty result: refining left nothing of the surface, curvature weight {:.3g}; a "
                                  "smaller --smoothing or --voxel may keep it",
                                  surface.refine->fit_weights.smoothing),
                      lambda);
  if (mesh.triangles.empty())
    throw EmptyResult(
        fmt::format("empty result: the smoothed indicator stays on one side of the isovalue {:.3g}; parts "
                    "thinner than two voxels need a smaller voxel than {:.4g}",
                    surface.isovalue, lattice.voxel),
        lambda);
  return mesh;
}

std::optional<RelaxReport> relax(Mesh& mesh, const Surface& surface, const GridSamples& samples, const Grid& grid,
                                 const ReconstructParams& params, Trace& trace, const Context& context) {
  if (!surface.refine || surface.refine->fit_weights.edge_preserving || !(params.surface.relax.split_tolerance > 0))
    return {};
  if (mesh.triangles.size() > most_relaxed)
    trace.warn(
        fmt::format("not relaxed: {} triangles, at most {} can be; flat triangles stay where the surface is curved",
                    mesh.triangles.size(), most_relaxed));
  return trace.stage("relax", [&] {
    return relax_mesh(mesh, SmoothField(surface.values().grid, surface.values().value, context), samples, surface.scale,
                      grid.lattice, params.surface.relax, context);
  });
}

void undo_border(Mesh& mesh, GridSamples& samples, const BorderReport& border) {
  if (border.chosen != Border::solid) return;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  for (Vec3f& direction : samples.direction) direction = -direction;
}

void warn_inside_out(const Mesh& mesh, const BorderReport& border, const Scanners& scanners,
                     const ReconstructParams& params, Trace& trace) {
  if (params.border.outside == Border::solid || !scanners.positions.empty()) return;
  if (!(mesh.volume() < 0) || !is_closed(mesh)) return;
  trace.warn(fmt::format(
      "the mesh is a hollow in solid matter, of negative volume, as most directions point inward (outside: {}): if it "
      "is a body, --directions estimate ignores them, --outside air keeps the outside free; a hollow is --outside "
      "solid",
      name_of(border.chosen)));
}

std::optional<TrimReport> trim(Mesh& mesh, const GridSamples& samples, std::vector<Ray> rays, const Grid& grid,
                               const ReconstructParams& params, Trace& trace, const Context& context) {
  if (!trims(params, grid.ends)) return {};
  TrimReport report;
  // The border's trials on a coarse level took this closed surface for mostly invented; of thin bodies they do not see
  // both sides.
  constexpr double mostly_seen = 0.75;
  const bool asked =
      params.trim.on || params.trim.distance || params.trim.fill_holes || params.border.outside != Border::automatic;
  const double least_beyond = grid.lattice.open || asked ? 0 : 1 - mostly_seen;
  const TrimSetup setup{params.trim, grid.density, grid.ends, least_beyond, std::move(rays)};
  trace.stage("trim", [&] { trim(mesh, samples, grid.lattice, setup, context, report); });
  announce_trim(report, params.trim, trace);
  if (mesh.triangles.empty())
    throw EmptyResult(
        fmt::format("empty result: no part of the surface within {:.3g} of a sample faces one; try --trim "
                    "off, or a smaller --voxel than {:.4g}",
                    report.distance, grid.lattice.voxel),
        0);
  return report;
}

Mesh fuse(const PointCloud& cloud, const Lattice& lattice, const ReconstructParams& params, VripReport& report,
          Trace& trace, const Context& context) {
  const FusedField fused = trace.stage("fuse", [&] {
    return fuse_scans({cloud, params.orient.sensor}, lattice, params.vrip, context, report);
  });
  Mesh mesh = trace.stage("extract", [&] {
    return extract_open_isosurface(fused.grid, fused.distance, fused.weight, 0, lattice, context);
  });
  if (mesh.triangles.empty())
    throw EmptyResult(fmt::format("empty result: the scans saw both sides of their surfaces in no whole cell; a grid "
                                  "nearer to their own spacing than voxel {:.4g} may",
                                  lattice.voxel),
                      0);
  return mesh;
}

}  // namespace soapfilm
