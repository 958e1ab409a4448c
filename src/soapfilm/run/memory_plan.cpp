#include "soapfilm/run/memory_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/error.h"
#include "soapfilm/finish/vertex_gap.h"
#include "soapfilm/place/place.h"
#include "soapfilm/refine/refine.h"
#include "soapfilm/relax/relax.h"
#include "soapfilm/run/defaults.h"
#include "soapfilm/simplify/engine.h"
#include "soapfilm/solve/graph_cut.h"
#include "soapfilm/solve/poisson.h"
#include "soapfilm/solve/sor.h"

namespace soapfilm {

namespace {

/// In addition to the support bricks a band contains those where holes are closed: measured 1.02 to 1.15 times as many.
constexpr double band_over_support = 1.1;
/// tv's finest band excludes support that needs no more work: measured 0.70 to 0.75 with a sample per voxel^2, 0.80 to
/// 0.82 with an eighth, 0.94 with 0.03.
constexpr double finest_over_support = 0.8;
/// Of scenes, which are solved with less of lambda: the flux is close to its bound far around their samples, and the
/// coarser level's would often break it. Measured 0.94 to 1.8 (a rock face seen from above), 1.2 to 1.7 as a rule.
constexpr double finest_over_support_of_scene = 1.5;
/// Certain shares of guesses (see Planned): of the solve's, until it begins; of the refinement's, until its band is
/// known; of the gap's, until tv's finest band begins.
constexpr double certain_of_solve = 0.9, certain_of_scene = 0.6, certain_of_refine = 0.75, certain_of_gap = 0.7;
/// Of the mesh's, until the surface is known: samples that are sparse, or noisy, reach more bricks than it does.
constexpr double certain_of_mesh = 0.5;
/// What is left of the coarser level and its data term while they are being freed, as a share of a whole band.
constexpr double coarser_share = 0.1;

/// Arrays on every vertex of the box while the solver works.
double dense_bytes_per_vertex(Method method) {
  if (method == Method::tv_sor) return sor_bytes_per_vertex;
  if (method == Method::poisson) return poisson_bytes_per_vertex;
  return 0;
}

/// Samples on a surface reach one brick per so many voxel^2 of it.
constexpr double area_per_brick = 20;

/// Two digits, not below the value.
double two_digits_above(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit) * unit;
}

/// Arrays over the whole box: of methods without a band, and the masks of graph cuts.
uint64_t box_bytes(Method method, const Lattice& lattice) {
  const Vec3i bricks = lattice.box(0).bricks;
  const double masks = is_graph_cut(method) ? graph_masks_per_brick * bricks.x * bricks.y * bricks.z : 0;
  constexpr double most = 0x1p60;  // fits in uint64_t; no machine has it
  return static_cast<uint64_t>(std::min(most, masks + dense_bytes_per_vertex(method) * lattice.vertices()));
}

/// The peak in addition to the box's arrays and the data term, bytes per support brick.
double band_bytes_per_brick(Method method, Kind kind) {
  const auto of_brick = static_cast<double>(level_bytes(1));
  const double level = band_over_support * of_brick;
  const auto graph = [](int neighbors) {
    return graph_vertices_per_brick * static_cast<double>(graph_bytes_per_vertex(neighbors, false));
  };
  switch (method) {
    case Method::tv:
      return (kind == Kind::scene ? finest_over_support_of_scene : finest_over_support) * of_brick +
             coarser_share * level;
    case Method::graph_cut_6:
      return level + graph(6);
    case Method::graph_cut_26:
      return level + graph(26);
    case Method::vrip:
      return 4.4 *
             static_cast<double>(support_bytes(1));  // in place of f: distances, weights, and the scan being fused
    case Method::poisson:
      return 0;  // the level is made when most of the box's arrays are gone
    case Method::tv_sor:
      break;
  }
  return level;
}

uint64_t cloud_bytes(const PointCloud& cloud) {
  uint64_t each = sizeof(Vec3d);
  if (!cloud.normals.empty()) each += sizeof(Vec3f);
  if (!cloud.sensors.empty()) each += sizeof(Vec3d);
  if (!cloud.weights.empty()) each += sizeof(float);
  if (!cloud.colors.empty()) each += sizeof(Rgb8);
  uint64_t bytes = each * cloud.size();
  for (const Scan& scan : cloud.scans)
    if (scan.range_grid) bytes += scan.range_grid->sample.size() * sizeof(int32_t);
  return bytes;
}

/// Or its normals have to be estimated.
bool knows_directions(const PointCloud& cloud) {
  return !cloud.normals.empty() || !cloud.sensors.empty() ||
         std::any_of(cloud.scans.begin(), cloud.scans.end(),
                     [](const Scan& scan) { return scan.sensor || scan.view_direction; });
}

/// Sorted: position, direction and hash; where there are no normals, also the view direction that a plane's normal
/// replaced.
uint64_t kept_bytes(const PointCloud& cloud) {
  const uint64_t weight = cloud.weights.empty() ? 0 : sizeof(float);
  return ((cloud.normals.empty() ? 3 : 2) * sizeof(Vec3f) + weight + sizeof(uint8_t)) * cloud.size();
}

/// Where levels adapt: the samples' spacing, twice, and what they are on other levels. Measured: 17 to 46 bytes.
uint64_t level_samples_bytes(const ReconstructParams& params, const PointCloud& cloud) {
  constexpr uint64_t each = 48;
  return params.place.adapt ? each * cloud.size() : 0;
}

}  // namespace

uint64_t plan_placing(const PointCloud& cloud) {
  const uint64_t given_bytes = program_bytes + cloud_bytes(cloud) + sizeof(Vec3f) * cloud.size();
  // While the cloud exists also the direction as found and the original index of sorted samples.
  const uint64_t sorted_bytes = kept_bytes(cloud) + sizeof(uint32_t) * cloud.size();
  // The surface around each: area, spacing, normal, and one number more; with it either the order of the samples and
  // the cells of two depths that found it, measured, or the sorted samples.
  constexpr uint64_t around_each = 3 * sizeof(float) + sizeof(Vec3f), cells_each = 63;
  const uint64_t around_bytes = around_each * cloud.size(), cells_bytes = cells_each * cloud.size();
  // Before, where normals are estimated: sites, neighbors, planes, and what spreads their signs. Measured.
  constexpr uint64_t estimated_each = 202;
  const uint64_t estimated_bytes = knows_directions(cloud) ? 0 : estimated_each * cloud.size();
  return given_bytes + std::max(around_bytes + std::max(sorted_bytes, cells_bytes), estimated_bytes);
}

uint64_t plan_fixed(Method method, const PointCloud& cloud, AfterPlacing after) {
  const bool keeps = after == AfterPlacing::kept || method == Method::vrip;
  return program_bytes + kept_bytes(cloud) + (keeps ? cloud_bytes(cloud) : 0);
}

MemoryPlan plan_memory(const ReconstructParams& params, const PointCloud& cloud, AfterPlacing after,
                       const Lattice& lattice, const Support& support) {
  const Method method = params.method;
  MemoryPlan plan;
  plan.placing_bytes = plan_placing(cloud);
  plan.fixed_bytes = plan_fixed(method, cloud, after) + level_samples_bytes(params, cloud);
  const bool scene = support.kind == Kind::scene;
  const double per_brick = band_bytes_per_brick(method, support.kind) + static_cast<double>(support_bytes(1));
  plan.tables_bytes = box_bytes(method, lattice);
  // tv's band becomes known only level by level.
  const bool guessed = method == Method::tv;
  plan.solve = {plan.tables_bytes + static_cast<uint64_t>(static_cast<double>(support.bricks) * per_brick),
                !guessed ? 1
                : scene  ? certain_of_scene
                         : certain_of_solve};
  if (params.surface.gap) plan.gap = {gap_bytes(support.bricks), certain_of_gap};
  if (guessed && (params.checked || simplifies(params.simplify)))
    plan.mesh = {
        mesh_bytes(static_cast<uint64_t>(area_per_brick / area_per_face * static_cast<double>(support.bricks)), params),
        certain_of_mesh};
  if (!refines(params)) return plan;

  plan.refine = {Refinement::bytes_of_support(support.bricks, scene, cloud.size()), guessed ? certain_of_refine : 1};
  return plan;
}

MemoryPlan plan_tables(Method method, const Lattice& lattice) {
  const uint64_t tables = box_bytes(method, lattice);
  MemoryPlan plan;
  plan.fixed_bytes = program_bytes;
  plan.solve.bytes = plan.tables_bytes = tables;
  return plan;
}

uint64_t mesh_bytes(uint64_t vertices, const ReconstructParams& params) {
  constexpr uint64_t checked_vertex_bytes = 470;  // measured: 423 to 518
  constexpr double split_triangles = 2.6;         // of a vertex, once edges are split; 2 without
  const uint64_t simplified =
      simplifies(params.simplify)
          ? simplify_bytes(static_cast<uint64_t>(split_triangles * static_cast<double>(vertices)))
          : 0;
  return std::max(params.checked ? checked_vertex_bytes * vertices : relax_bytes(vertices), simplified);
}

Room::Room(std::optional<uint64_t> limit, uint64_t held) : what(limit ? "--memory" : "free memory") {
  const uint64_t available = available_memory_bytes();
  bytes = limit ? *limit : available > SIZE_MAX - held ? SIZE_MAX : available + held;
}

void check_memory(const MemoryPlan& plan, const Room& room, const Lattice& lattice, double area, bool by_resolution) {
  if (plan.least() <= room.bytes) return;
  const double left = room.bytes > plan.fixed_bytes ? static_cast<double>(room.bytes - plan.fixed_bytes) : 0;
  const auto tables = static_cast<double>(plan.tables_bytes);
  // Before the samples are sorted the number of bricks is unknown.
  const double bands = std::max(static_cast<double>(plan.grid_bytes()) - tables,
                                area / area_per_brick * static_cast<double>(Refinement::bytes_of_support(1, false, 0)));
  constexpr double most_times_coarser = 1e9;
  double coarser = 1;
  while (tables / (coarser * coarser * coarser) + bands / (coarser * coarser) > 0.7 * left &&
         coarser < most_times_coarser)
    coarser *= 1.01;
  const int longest = std::max({lattice.size.x, lattice.size.y, lattice.size.z}), around = 2 * lattice.padding;
  const int fits = around + static_cast<int>((longest - around) / coarser);
  const std::string fit = fits <= around || coarser >= most_times_coarser ? "no resolution would fit"
                          : by_resolution
                              ? fmt::format("a resolution of about {} would fit", fits)
                              : fmt::format("--voxel {:.2g} would fit", two_digits_above(coarser * lattice.voxel));
  throw MemoryError(
      fmt::format("memory: {} needs about {}, {} is {}; {}",
                  by_resolution ? fmt::format("resolution {}", longest) : fmt::format("voxel {:.4g}", lattice.voxel),
                  format_bytes(plan.total()), room.what, format_bytes(room.bytes), fit));
}

void check_placing(uint64_t placing_bytes, const Room& room, uint64_t samples) {
  if (placing_bytes > room.bytes)
    throw MemoryError(fmt::format("memory: {} samples need about {}, {} is {}; no resolution would fit", samples,
                                  format_bytes(placing_bytes), room.what, format_bytes(room.bytes)));
}

double smallest_voxel(const PointCloud& cloud, double area, const ReconstructParams& params, const Context& context) {
  const Box3d box = cloud.box();
  const Room room(context.memory_limit(), held_memory_bytes());
  const auto fits = [&](double voxel) {
    const Lattice lattice = place_lattice(box, voxel, params.place.padding);
    const double voxels2 = area / (voxel * voxel);
    if (voxels2 > 1e12) return false;
    const auto bricks = static_cast<uint64_t>(voxels2 / area_per_brick);
    MemoryPlan plan = plan_memory(params, cloud, AfterPlacing::freed, lattice, {bricks});
    plan.mesh = {mesh_bytes(static_cast<uint64_t>(voxels2 / area_per_face), params), 1};
    return plan.total() <= room.bytes;
  };
  constexpr double step = 1.02, most_vertices = 1e5;
  double voxel = box.longest() / 8;
  if (!(area > 0) || !(voxel > 0) || !fits(voxel)) return 0;
  while (box.longest() / voxel < most_vertices && fits(voxel / step)) voxel /= step;
  return two_digits_above(voxel);
}

MemoryBudget::MemoryBudget(const ReconstructParams& params, const PointCloud& cloud, AfterPlacing after,
                           const Context& context)
    : params_(params), after_(after), room_(context.memory_limit(), held_memory_bytes()), scratch_(params, context) {
  plan_.placing_bytes = plan_placing(cloud);
  const bool on_disk = scratch_.takes(plan_, room_);
  check_placing(on_disk ? scratch_.resident_part(plan_).placing_bytes : plan_.placing_bytes, room_, cloud.size());
}

void MemoryBudget::check() {
  const bool by_resolution = params_.place.resolution && !params_.place.voxel;
  if (!scratch_.takes(plan_, room_)) return check_memory(plan_, room_, lattice_, area_, by_resolution);
  // What must stay of arrays on disk is a guess from above. Once all is solved it must be far off to be worth losing
  // that: with less the run is slow.
  constexpr double late_margin = 1.25;
  const MemoryPlan resident = scratch_.resident_part(plan_);
  if (solved_ && static_cast<double>(resident.least()) <= late_margin * static_cast<double>(room_.bytes)) return;
  check_memory(resident, room_, lattice_, area_, by_resolution);
}

void MemoryBudget::take(const MemoryPlan& plan) {
  plan_ = plan;
  check();
}

void MemoryBudget::plan_tables(const PointCloud& cloud, const Box3d& box, const Lattice& lattice, double area) try {
  lattice_ = lattice;
  area_ = area;
  plan_ = soapfilm::plan_tables(params_.method, lattice);
  check();
} catch (const MemoryError& error) {
  throw MemoryError(error.what() + far_samples(cloud, box));
}

void MemoryBudget::plan_grid(const PointCloud& cloud, const Support& support) {
  plan_ = plan_memory(params_, cloud, after_, lattice_, support);
  check();
  first_ = planned_bytes();
}

std::string MemoryBudget::summary() const {
  const std::string in_memory = format_bytes(planned_bytes());
  if (!scratch_.used()) return in_memory;
  const ScratchTraffic traffic = scratch_.traffic(plan_, room_);
  return fmt::format("{}, {} on disk in {}, about {} to be read and {} written", in_memory,
                     format_bytes(planned_disk_bytes()), scratch_.folder(), format_bytes(traffic.read),
                     format_bytes(traffic.written));
}

PyramidObserver MemoryBudget::watch(PyramidObserver user, uint64_t data_bricks) {
  user.begins = [this, data_bricks, begins = user.begins](int level, uint64_t bricks, uint64_t beside) {
    plan_level(level, data_bricks, bricks, beside);
    if (begins) begins(level, bricks, beside);
  };
  // The first graph is the plan's.
  user.cuts = [this, data_bricks, is_first = true](size_t vertices) mutable {
    if (!std::exchange(is_first, false)) plan_cut(vertices, data_bricks);
  };
  return user;
}

void MemoryBudget::plan_cut(uint64_t vertices, uint64_t data_bricks) {
  // Samples too sparse for the grid leave ways through the band, which then grows far beyond them.
  const int neighbors = neighbors_of_cut(params_.method);
  const uint64_t graph = graph_bytes_per_vertex(neighbors, true) * vertices;
  plan_.solve.bytes = std::max(plan_.solve.bytes, plan_.tables_bytes + support_bytes(data_bricks) + graph);
  check();
}

void MemoryBudget::plan_level(int level, uint64_t data_bricks, uint64_t bricks, uint64_t beside) {
  // The largest level counts, and replaces the guess from before the first one.
  const uint64_t before = plan_.solve.certain < 1 ? 0 : plan_.solve.bytes;
  plan_.solve = {std::max(before, support_bytes(data_bricks) + level_bytes(bricks + beside)), 1};
  if (level == 0 && params_.surface.volume_interval) plan_.solve.bytes += support_bytes(bricks);
  if (level == 0 && params_.surface.gap) plan_.gap = {gap_bytes(bricks), 1};
  if (level == 0 && refines(params_)) plan_.refine = {Refinement::bytes_of_level(bricks), certain_of_refine};
  check();
}

bool MemoryBudget::plan_beside(uint64_t bytes) {
  if (solve_alone_ == 0) solve_alone_ = plan_.solve.bytes;
  bytes += plan_.kept_bytes;
  MemoryPlan both = plan_;
  both.solve.bytes = std::max(plan_.solve.bytes, solve_alone_ + bytes);
  if (plan_.fixed_bytes + solve_alone_ + plan_.gap.bytes + bytes > room_.bytes && !scratch_.holds(both, room_))
    return false;
  plan_ = both;
  scratch_.takes(plan_, room_);
  return true;
}

bool MemoryBudget::plan_kept(uint64_t bytes, uint64_t beside) {
  if (solve_alone_ == 0) solve_alone_ = plan_.solve.bytes;
  MemoryPlan kept = plan_;
  kept.kept_bytes = bytes;
  kept.joint_bytes = bytes + beside;
  const uint64_t other = plan_.fixed_bytes + plan_.gap.bytes;
  if (other + bytes + std::max(solve_alone_, beside) > room_.bytes && !scratch_.holds(kept, room_)) return false;
  plan_ = kept;
  scratch_.takes(plan_, room_);
  return true;
}

void MemoryBudget::plan_mesh(const Labels& labels, uint64_t faced_samples, const Context& context) {
  solved_ = true;
  if (params_.method != Method::tv) return;
  constexpr uint64_t faced_bytes = 45;  // their places and a tree over them, and directions in addition to the views
  plan_.mesh = {mesh_bytes(count_faces(labels, context), params_) + faced_bytes * faced_samples, 1};
  check();
}

void MemoryBudget::plan_refinement(uint64_t rows, bool tries_coarser, uint64_t samples) {
  plan_.refine = {Refinement::bytes(rows, tries_coarser, samples), 1};
  check();
}

}  // namespace soapfilm
