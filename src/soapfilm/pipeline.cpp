#include "soapfilm/pipeline.h"
#include "soapfilm/core/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "soapfilm/announce.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/extract/bend.h"
#include "soapfilm/extract/cut.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/finish/islands.h"
#include "soapfilm/finish/sample_distance.h"
#include "soapfilm/finish/scanners.h"
#include "soapfilm/finish/self_check.h"
#include "soapfilm/finish/trim.h"
#include "soapfilm/fuse/vrip.h"
#include "soapfilm/pyramid/critical_lambda.h"
#include "soapfilm/solve/closed_border.h"

namespace soapfilm {

namespace {

/// E(0) = 0 competes: a surface must have a lower energy, or the optimum is empty. (A cut has done so in its own
/// energy, poisson's surface owes nothing to lambda: theirs only has to be there.)
void require_surface(const ReconstructReport& report, const SupportField& field, const Context& context) {
  const double lambda = report.certificate.lambda;
  const bool kept = is_certified(report.params.method) ? report.certificate.binary.primal < 0 : report.inside > 0;
  if (kept) return;
  const double largest = critical_lambda(report.lattice, field, lambda, context, report.params.energy.norm);
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

void judge(const Level& level, double threshold, const Context& context, ReconstructReport& report) {
  const auto mu = static_cast<float>(threshold);
  // What tv's solver saw last is this state, and a proof where no rounding left p outside of its ball.
  const bool proved = !report.levels.empty() && report.levels.back().energies.max_dual_norm <= 1;
  report.certificate.relaxed =
      proved ? report.levels.back().energies : evaluate_energy(level, {.threshold = {}, .certify = true}, context);
  report.certificate.binary = evaluate_energy(level, {.threshold = mu, .certify = true}, context);
  report.inside = count_inside(level, mu, context);
}

/// The views of the samples on the grid, as long as their directions.
std::vector<Vec3f> sort_views(std::span<const Vec3f> views, const GridSamples& samples, const Lattice& lattice,
                              const Context& context) {
  std::vector<Vec3f> sorted;
  reserve_many(sorted, samples.size(), context.pages());
  sorted.resize(samples.size());
  parallel_for(context, samples.size(), size_t{1} << 14, [&](size_t k) {
    sorted[k] = normalized(lattice.from_world_axes(views[samples.source[k]])) * norm(samples.direction[k]);
  });
  return sorted;
}

}  // namespace

Pipeline::Pipeline(const ReconstructParams& params, const Context& context, const PyramidObserver& observe)
    : params_(params), context_(context), observe_(observe), stages_(context) {
  validate(params);
  context_.pages().restart_peak();
  report_.params = params;
}

void Pipeline::check(const PointCloud& cloud) {
  box_ = check_samples(cloud, context_);
  if (params_.method == Method::vrip)
    for (const Scan& scan : cloud.scans) require_range_scan(scan, params_.orient.sensor);
  room_ = check_room(cloud, params_);
  scanner_positions_ = scanner_positions(cloud, params_.orient.sensor);
}

std::vector<Vec3f> Pipeline::orient(const PointCloud& cloud) {
  auto directions = stages_.run("orient", [&] {
    OrientParams how = params_.orient;
    how.from_within = params_.border.outside == Border::solid;
    OrientReport& report = report_.input.directions;
    auto found = soapfilm::orient(cloud, how, context_, report);
    const auto measure = [&] { local_surface_ = measure_local_surface(cloud.positions, found, box_, context_); };
    measure();
    if (doubt_signs(cloud, how, local_surface_.sides, context_, found, report)) measure();
    // Where each sample has a normal, there is nothing to turn.
    if (params_.orient.source == DirectionSource::automatic && report.from_normals < cloud.size()) {
      if (refines(params_)) views_ = found;
      turn_to_planes(cloud, local_surface_, context_, found, report);
      if (report.from_planes == 0) views_ = {};
    }
    if (params_.border.outside == Border::automatic && params_.method == Method::tv)
      scanners_ = look_around(cloud, params_.orient.sensor, context_);
    return found;
  });
  report_.warnings = report_.input.directions.warnings;  // which it has shown
  return directions;
}

GridSamples Pipeline::place(const PointCloud& cloud, std::span<const Vec3f> directions, AfterPlacing after) {
  auto samples = stages_.run("place", [&] {
    GridSamples sorted = soapfilm::place(cloud, box_, directions, local_surface_, params_, *room_, context_, report_);
    const size_t support = support_mask(sorted, report_.lattice.box(0), context_).count();
    plan_ = plan_memory(params_.method, refines(params_), cloud, after, report_.lattice, support);
    plan_again(params_.method == Method::tv);
    return sorted;
  });
  announce_grid(report_, context_.progress());
  return samples;
}

void Pipeline::weigh(const PointCloud& cloud, std::span<const Vec3f> directions, GridSamples& samples) {
  stages_.run("weigh", [&] { weigh_area(cloud, directions, local_surface_, params_, context_, samples, report_); });
  local_surface_ = {};
  if (!views_.empty()) views_ = sort_views(views_, samples, report_.lattice, context_);
  announce_weight(report_, context_.progress());
}

Mesh Pipeline::fuse(const PointCloud& cloud) {
  const FusedField fused = stages_.run("fuse", [&] {
    return fuse_scans({cloud, params_.orient.sensor}, report_.lattice, params_.vrip, context_, report_.vrip.emplace());
  });
  Mesh mesh = stages_.run("extract", [&] {
    return extract_open_isosurface(fused.grid, fused.distance, fused.weight, 0, report_.lattice, context_);
  });
  if (mesh.triangles.empty())
    throw EmptyResult(fmt::format("empty result: the scans saw both sides of their surfaces in no whole cell; a grid "
                                  "nearer to their own spacing than voxel {:.4g} may",
                                  report_.lattice.voxel),
                      0);
  return mesh;
}

void Pipeline::plan_again(bool guessed) {
  report_.planned_bytes = plan_.total();
  // Guesses may be too large: the solve's, until it begins, by a tenth; the refinement's by a third.
  const auto share = [](double part, size_t bytes) { return static_cast<size_t>(part * static_cast<double>(bytes)); };
  MemoryPlan least = plan_;
  if (guessed) least.refine_bytes = share(0.75, plan_.refine_bytes);
  if (guessed && first_plan_ == 0) least.solve_bytes = share(0.9, plan_.solve_bytes);
  check_memory(plan_, least.total(), *room_, report_.lattice, 0, params_.place.resolution && !params_.place.voxel);
}

SupportField Pipeline::field(const GridSamples& samples) {
  return stages_.run("field", [&] { return divergence_field(samples, report_.lattice.box(0), context_); });
}

void Pipeline::border(SupportField& field, GridSamples& samples) {
  const BorderParams& asked = params_.border;
  BorderReport& border = report_.border;
  if (asked.outside == Border::automatic && params_.method != Method::tv) {
    warn_inward(report_, context_.progress());
    return;
  }
  stages_.run("border", [&] {
    if (asked.outside == Border::automatic) {
      border = choose_border(
          {report_.lattice, field, report_.certificate.lambda, params_.energy.norm, report_.input.density}, scanners_,
          asked, params_.solve, context_);
    } else {
      border.chosen = asked.outside;
      border.reason = "as asked for";
    }
    report_.lattice.open = border.chosen == Border::open;
    if (border.chosen != Border::solid) return;
    negate(field, context_);
    for (Vec3f& direction : samples.direction) direction = -direction;
    for (Vec3f& view : views_) view = -view;
  });
  announce_border(report_, context_.progress());
  warn_inward(report_, context_.progress());
}

void Pipeline::plan_mesh(const Level& level, bool checked) {
  if (params_.method != Method::tv) return;
  plan_.mesh_bytes = mesh_bytes(count_faces(level, params_.surface.threshold, context_), checked);
  plan_again(true);
}

Segmentation Pipeline::solve(const SupportField& field, const GridSamples& samples) {
  keep_.emplace(context_.pages());
  PyramidObserver observe = observe_;
  size_t most = 0;
  observe.begins = [&, user = observe_.begins](int level, size_t bricks, size_t beside) {
    plan_.solve_bytes = most = std::max(most, solve_bytes(field.grid.size(), bricks + beside));
    if (level == 0 && refines(params_)) plan_.refine_bytes = guess_refine_bytes(bricks);
    plan_again(true);
    if (user) user(level, bricks, beside);
  };
  first_plan_ = plan_.total();
  auto found = stages_.run(
      "solve", [&] { return segment(report_.lattice, field, samples, params_, observe, context_, report_); });
  if (!found.level.box.open) plan_mesh(found.level, params_.checked);
  warn_unconverged(report_, context_.progress());
  return found;
}

void Pipeline::certify(Level& level, SupportField& field) {
  stages_.run("certify", [&] { judge(level, params_.surface.threshold, context_, report_); });
  require_surface(report_, field, context_);
  announce_energy(report_, context_.progress());
  level.p = {};
  field.f = {};
  if (!level.box.open) return;
  level = closed_at_border(level, context_);
  // What closes it is drawn as well, until it is cut off; what is checked is much smaller.
  plan_mesh(level, false);
}

void Pipeline::drop_islands(Level& level, const GridSamples& samples) {
  if (!drops_islands(params_)) return;
  stages_.run("finish", [&] {
    soapfilm::drop_islands(level, static_cast<float>(params_.surface.threshold), samples, report_.input.density,
                           params_.islands, context_, report_.islands.emplace());
  });
  announce_islands(report_, context_.progress());
}

void Pipeline::place_scanners(const Level& level) {
  for (Vec3d& p : scanner_positions_) p = report_.lattice.to_lattice(p);
  report_.scanners = soapfilm::place_scanners(level, static_cast<float>(params_.surface.threshold),
                                              report_.border.chosen == Border::solid, scanner_positions_);
}

/// The field whose level set at report.isovalue is the surface: sub-voxel accurate, or the paper's (section 4.4).
SurfaceField Pipeline::level_set(Segmentation& found, const GridSamples& samples) {
  const auto threshold = static_cast<float>(params_.surface.threshold);
  if (found.surface) {
    report_.isovalue = 0.5;
    return std::move(*found.surface);
  }
  if (refines(params_)) {
    RefineParams how = params_.refine;
    how.vanish = drops_islands(params_);
    how.open = report_.lattice.open;
    Refinement refinement(std::move(found.level), threshold, samples, report_.input.density, how, context_,
                          report_.refine.emplace());
    plan_.refine_bytes = refine_bytes(refinement.rows(), refinement.tries_coarser(), samples.size());
    plan_again(false);
    return refinement.fit();
  }
  SurfaceField surface = smoothed_indicator(found.level, threshold, context_);
  report_.isovalue = params_.surface.isovalue ? *params_.surface.isovalue : mean_at_samples(surface, samples, context_);
  return surface;
}

SurfaceField Pipeline::refine(Segmentation& found, GridSamples& samples) {
  // Planes tell of samples that are held out, too: the fit must not believe their normals for serving these well.
  if (!views_.empty()) samples.direction = std::move(views_);
  SurfaceField surface = stages_.run("refine", [&] { return level_set(found, samples); });
  announce_plan(first_plan_, report_, context_.progress());
  announce_refinement(report_, context_.progress());
  return surface;
}

Mesh Pipeline::extract(const SurfaceField& surface) {
  Mesh mesh = stages_.run("extract", [&] {
    return extract_isosurface(
        surface.grid, surface.value, [&](Vec3i brick) { return surface.missing_value(brick); },
        static_cast<float>(report_.isovalue), report_.lattice, context_);
  });
  keep_.reset();
  if (mesh.triangles.empty())
    throw EmptyResult(
        fmt::format("empty result: the smoothed indicator stays on one side of the isovalue {:.3g}; parts "
                    "thinner than two voxels need a smaller voxel than {:.4g}",
                    report_.isovalue, report_.lattice.voxel),
        report_.certificate.lambda);
  return mesh;
}

void Pipeline::bend(Mesh& mesh, const SurfaceField& surface, const GridSamples& samples) {
  if (!report_.refine || report_.refine->strength.yield || !(params_.surface.bend.tolerance > 0)) return;
  stages_.run("bend", [&] {
    bend_edges(mesh, SmoothField(surface.grid, surface.value, context_), samples,
               params_.refine.robust.scale(report_.refine->strength.noise), report_.lattice, params_.surface.bend,
               context_, report_.bend.emplace());
  });
}

void Pipeline::finish_border(Mesh& mesh) {
  if (report_.border.chosen == Border::solid)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  if (report_.border.chosen == Border::open) cut_at_border(mesh, report_.lattice);
}

void Pipeline::trim(Mesh& mesh, const GridSamples& samples) {
  if (!trims(params_, report_.border.chosen)) return;
  stages_.run("trim", [&] {
    soapfilm::trim(mesh, samples, report_.lattice, report_.input.density, params_.trim, context_,
                   report_.trim.emplace());
  });
  announce_trim(report_, context_.progress());
}

void Pipeline::self_check(const Mesh& mesh, const GridSamples& samples) {
  stages_.run("self-check",
              [&] { report_.self_check = soapfilm::self_check(mesh, samples, report_.lattice, context_); });
  announce_self_check(report_, context_.progress());
}

void Pipeline::attribute(Mesh& mesh, const GridSamples& samples) {
  if (!params_.surface.distance) return;
  stages_.run("distance", [&] {
    mesh.attributes.push_back({"distance", distances_to_samples(mesh, samples, report_.lattice, context_)});
  });
}

Reconstruction Pipeline::finish(Mesh mesh) {
  report_.mesh_vertices = mesh.vertices.size();
  report_.mesh_triangles = mesh.triangles.size();
  report_.stages = stages_.times();
  report_.peak_bytes = peak_memory_bytes();
  report_.array_bytes = context_.pages().peak_bytes();
  return {std::move(mesh), std::move(report_)};
}

}  // namespace soapfilm
