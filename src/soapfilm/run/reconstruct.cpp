// The file to read first: from a cloud to its mesh. Each stage takes what it needs and returns a value that keeps its
// meaning; data that is no longer needed is freed here. docs/architecture.md says in which folder each stage is.
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/method.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/field/terms.h"
#include "soapfilm/finish/rays.h"
#include "soapfilm/orient/scan_fit.h"
#include "soapfilm/run/adapt.h"
#include "soapfilm/run/announce.h"
#include "soapfilm/run/certify.h"
#include "soapfilm/run/finish.h"
#include "soapfilm/run/kept_stages.h"
#include "soapfilm/run/other_levels.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/run.h"
#include "soapfilm/run/segment.h"
#include "soapfilm/run/solve_jointly.h"
#include "soapfilm/run/surface.h"
#include "soapfilm/solve/closed_border.h"

namespace soapfilm {

Reconstruction run(const PointCloud& cloud, PointCloud* owned, const ReconstructParams& params, const Context& context,
                   const Experiment& experiment) {
  validate(params);
  pages_of(context).restart_peak();
  Trace trace(context);
  const Box3d box = check_cloud(cloud, params, context);
  MemoryBudget memory(params, cloud, owned ? AfterPlacing::freed : AfterPlacing::kept, context);

  // Each sample gets a weak outward direction: its normal, towards the scanner, or estimated.
  KeptStages kept(cloud, params, memory, context);  // after a crash, by --resume
  Orientation oriented =
      trace.stage("orient", [&] { return kept.orient([&] { return find_directions(cloud, box, params, context); }); });
  trace.keep(oriented.report.warnings);
  if (auto misfit = misfit_of_scans(cloud, oriented.directions, context)) trace.warn(std::move(*misfit));
  const Scanners scanners = find_scanners(cloud, oriented.report, params, context);

  // The grid: its voxel, its position, and the memory needed.
  Placed placed = trace.stage("place", [&] { return place(cloud, box, oriented, scanners, params, memory, context); });
  kept.keep(oriented);
  Grid& grid = placed.grid;
  GridSamples& samples = placed.samples;
  std::vector<Ray> rays = some_rays(cloud, params.orient.sensor, grid.lattice, context);
  SampleAttributes attributes = sort_attributes(cloud, samples, params.surface.attributes);
  announce_grid(grid, memory, trace);

  // Lambda, the weight of area against the samples; and the samples' weights, by the area that they represent.
  const char* weights = uses_lambda(params.method) ? "lambda" : "weights";
  const Lambda lambda =
      trace.stage(weights, [&] { return choose_lambda(cloud, oriented, scanners, grid, params, samples, context); });
  announce_lambda(lambda, grid, params, trace);
  const auto details = std::make_shared<ReportDetails>();
  ReconstructReport report = facts_of(cloud, box, params, oriented.report, grid, lambda, details);

  // Curless and Levoy's surface needs neither data term nor solve: its scans say what is known.
  if (params.method == Method::vrip) {
    Mesh mesh = fuse(cloud, grid.lattice, params, details->vrip.emplace(), trace, context);
    carry(attributes, samples, grid.lattice, trace, context, mesh);
    return finish(std::move(mesh), std::move(report), samples, grid.lattice, memory, trace, context);
  }
  std::vector<float> spacings = sort_spacings(oriented.surface, samples, grid, params, context);
  if (!spacings.empty()) add_spacing(attributes, spacings, grid.lattice.voxel);
  std::vector<Vec3f> views = sort_views(oriented.views, samples, grid.lattice, context);
  oriented = {};
  release(samples.source);
  if (owned) *owned = {};

  // The data term f = div v (section 4.1).
  SupportField field = trace.stage("field", [&] { return data_field(samples, grid.lattice.box(0), context); });

  // Beyond the samples' box: air, solid matter (then the complement is solved, its directions reversed), or neither.
  BorderReport border = find_border(field, grid, lambda.value, scanners, params, context, trace);
  grid.lattice.open = border.chosen == Border::open;
  grid.ends = border.ends;
  if (!grid.ends) release(rays);
  reverse_for_solid(border, field, samples, views, context);
  find_reversed_body(border, report.input.directions, scanners, params, samples, context);
  announce_border(border, report.input.directions.inward, trace);

  // Inside or outside: the convex problem (4), coarse to fine, on a narrow band; or one of the methods for comparison.
  std::optional<PagePool::Keep> pages;
  if (!ranks_of(context)) pages.emplace(pages_of(context));  // they would fill what a rank has no values for
  const bool adapts = !spacings.empty();
  CoarseLevels coarse(context);  // kept where levels adapt
  const PyramidObserver observe = adapts ? coarse.watch(experiment.observe) : experiment.observe;
  Segmentation found = trace.stage("solve", [&] {
    return segment(grid.lattice, field, samples, lambda.value, params,
                   kept.watch(memory.watch(observe, field.grid.size())), context);
  });
  warn_unconverged(found.report, lambda.value, params, trace);
  details->solve = found.report;

  // How far from the global optimum, at most.
  std::optional<GapField> gap = trace.stage("certify", [&] {
    report.certificate = certify(found, grid, field, lambda.value, params, context);
    return find_gap(found.level, report.certificate, params, context);
  });
  announce_energy(report.certificate, params, trace);

  if (params.surface.volume_interval) {
    details->volumes =
        trace.stage("volumes", [&] { return volumes_near(found.level, report.certificate, params, context); });
    announce_volumes(*details->volumes, grid.lattice.voxel, trace);
  }

  // From here on only the side of each vertex counts; where levels adapt, others start from the solution.
  const auto threshold = static_cast<float>(params.surface.threshold);
  Labels labels = labels_of(found.level, threshold, context);
  if (!adapts) {
    found.level = {};
    field = {};
  }
  memory.plan_mesh(labels, grid.ends ? samples.size() : 0, context);
  if (border.chosen == Border::open) labels = closed_at_border(labels, context);

  // Components and cavities supported by too few samples are removed. (The certificate is of the solution with them.)
  report.components = drop_unsupported(labels, samples, grid, params, trace, context);

  // Scanners must stand in the air, and a hollow around one must be seen.
  report.scanners = stand_scanners(labels, scanners, grid, border);

  // Where samples are dense or sparse, finer or coarser levels from this solution, and one solution of all of them.
  std::optional<AdaptedSurface> adapted;
  if (adapts) {
    const LevelTask task{grid, lambda.value, params, experiment.robust, experiment.observe};
    LevelSamples own{std::move(samples), std::move(views), std::move(spacings)};
    if (!memory.plan_kept(coarse.bytes()) || !memory.plan_beside(0)) coarse.clear();
    SolvedLevels solved = trace.stage("adapt", [&] {
      return solve_other_levels(own, with_sides(std::move(found.level), std::move(field), threshold, labels, context),
                                task, memory, trace, context);
    });
    details->solve.levels.insert(details->solve.levels.end(), solved.reports.begin(), solved.reports.end());
    const JointTask jointly{params, memory, trace};
    if (solved.regions.coarsest() > 0 && plan_joint_solve(solved, coarse, jointly))
      adapted = trace.stage("join levels", [&]() -> std::optional<AdaptedSurface> {
        const LevelSamples& kept = solved.kept ? *solved.kept : own;
        std::optional<std::vector<Labels>> sides =
            solve_jointly(solved, std::move(coarse), kept.samples, jointly, report.certificate, *details, context);
        if (!sides) return {};
        AdaptedSurface others = find_other_surfaces(own, solved, *sides, task, context);
        labels = std::move((*sides)[static_cast<size_t>(solved.lattice.added)]);
        if (labels.box.open) labels = closed_at_border(labels, context);
        return others;
      });
    if (!adapted) memory.plan_kept(0);
    samples = std::move(own.samples);
    views = std::move(own.views);
    announce_leaves(report.certificate, params.method, *details, trace);
  }

  // The level set moves onto the samples; components and genus stay, except for parts that it shrinks to nothing. From
  // here on the directions are the original ones, not those of planes: the planes depend on held-out samples, too.
  if (!views.empty()) samples.direction.swap(views);
  Surface surface = trace.stage("refine", [&] {
    if (found.surface) return Surface{std::move(*found.surface), 0.5, {}};
    return kept.refine(
        [&] { return find_surface(std::move(labels), samples, grid, params, experiment.robust, memory, context); });
  });
  announce_refinement(surface.refine, memory, params, trace);

  // The level set as a manifold mesh, closed but for the border of an open box.
  Mesh mesh = trace.stage("extract", [&] {
    return adapted ? triangles_of(*adapted, surface, lambda.value, *details, context)
                   : triangles_of(surface, grid.lattice, lambda.value, context);
  });
  if (adapts) announce_levels(*details, trace);

  pages.reset();

  // Where the surface is curved, triangles as large as a voxel are too coarse: edges are split, vertices moved. Those
  // of coarser levels stay: their samples are too few to say where to.
  report.relax = adapted ? relax(mesh, surface, samples, *adapted, grid, params, trace, context)
                         : relax(mesh, surface, samples, grid, params, trace, context);
  // What follows is work for one process.
  details->ranks = times_of_ranks(trace.times(), context);
  if (ranks_of(context) && ranks_of(context)->rank() > 0) return {};
  report.isovalue = surface.isovalue;
  report.refine = summary_of(surface);
  details->refine = std::move(surface.refine);
  surface.field = {};

  if (!views.empty()) samples.direction.swap(views);

  // Flips a complement's faces. Removes surface that nobody saw.
  undo_border(mesh, samples, border);
  report.trim = trim(mesh, samples, std::move(rays), grid, params, trace, context);
  warn_inside_out(mesh, border, scanners, params, trace);

  carry(attributes, samples, grid.lattice, trace, context, mesh);
  if (adapted) carry_levels(*adapted, context, mesh);
  carry(gap, grid.lattice, trace, context, mesh);
  gap.reset();
  report_border(border, grid.lattice, report, *details);
  return finish(std::move(mesh), std::move(report), samples, grid.lattice, memory, trace, context);
}

}  // namespace soapfilm
