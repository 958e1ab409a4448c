#include "soapfilm/plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/core/error.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

namespace {

/// The program itself with its libraries, threads and file buffers.
constexpr size_t base_bytes = size_t{12} << 20;

/// A brick of a level: u and p, the layers that a sweep leaves behind, rim fluxes (about one face in three), topology
/// twice (band and support).
constexpr size_t level_brick_bytes = brick_volume * 4 * sizeof(float) + 3 * brick_area * sizeof(float) +
                                     brick_area * sizeof(float) + 2 * (sizeof(Vec3i) + sizeof(BrickGrid::Neighbors)) +
                                     128;
constexpr size_t data_brick_bytes = brick_volume * sizeof(float);

/// Beyond the support bricks a band holds what closes holes: measured 1.02 to 1.15 times as many.
constexpr double band_over_support = 1.1;
/// tv's finest band leaves out support that needs no more work: measured 0.70 to 0.75 with a sample per voxel^2, 0.80
/// to 0.82 with an eighth, 0.94 with 0.03.
constexpr double finest_over_support = 0.8;
/// What is left of the coarser level and its data term while they go back, as a share of a whole band.
constexpr double coarser_share = 0.1;

/// Refinement: the narrow band and the fit's arrays, bytes per support brick;
/// and of each cell with samples, of which a brick has about as many as given here where samples are dense. (What
/// sparse samples spare by a fit on coarser vertices is known too late.)
constexpr size_t refined_brick_bytes = 11400;
constexpr size_t refined_cell_bytes = 33;
constexpr size_t refined_cells_per_brick = 32;

/// Arrays on every vertex of the box while the solver works, bytes per vertex (docs/methods.md has what they hold).
double dense_bytes_per_vertex(Method method) {
  if (method == Method::tv_sor) return 7;
  if (method == Method::poisson) return 17.2;
  return 0;
}

/// What spans the whole box: bits per brick in masks and grids, and the arrays of methods that know no band.
size_t box_bytes(Method method, const Lattice& lattice) {
  const Vec3i bricks = lattice.box(0).bricks;
  const double count = static_cast<double>(bricks.x) * bricks.y * bricks.z;
  constexpr double masks = 6;      // support, band, inside; each beside its coarser or older one
  constexpr double ranks = 3 * 2;  // BrickGrid's two bits: samples, data, level
  return static_cast<size_t>((masks + ranks) * count / 8 + dense_bytes_per_vertex(method) * lattice.vertices());
}

/// The peak beside the box's arrays and the data term, bytes per support brick.
double band_bytes_per_brick(Method method) {
  const double level = band_over_support * level_brick_bytes;
  // Vertices with f != 0 and those around them fill more than half of the support's bricks.
  const double graph_vertices = 0.58 * brick_volume;
  switch (method) {
    case Method::tv:
      return finest_over_support * level_brick_bytes + coarser_share * level;
    case Method::graph_cut_6:
      return level + 117 * graph_vertices;
    case Method::graph_cut_26:
      return level + 345 * graph_vertices;
    case Method::vrip:
      return 4.4 * data_brick_bytes;  // in place of f: distances, weights, and the scan being fused
    case Method::poisson:
      return 0;  // the level is made when most of the box's arrays are gone
    case Method::tv_sor:
      break;
  }
  return level;
}

size_t cloud_bytes(const PointCloud& cloud) {
  size_t each = sizeof(Vec3d);
  if (!cloud.normals.empty()) each += sizeof(Vec3f);
  if (!cloud.sensors.empty()) each += sizeof(Vec3d);
  if (!cloud.weights.empty()) each += sizeof(float);
  if (!cloud.colors.empty()) each += sizeof(Rgb8);
  size_t bytes = each * cloud.size();
  for (const Scan& scan : cloud.scans)
    if (scan.range_grid) bytes += scan.range_grid->sample.size() * sizeof(int32_t);
  return bytes;
}

/// Sorted: position, direction and lot.
size_t kept_bytes(const PointCloud& cloud) { return (2 * sizeof(Vec3f) + sizeof(uint8_t)) * cloud.size(); }

}  // namespace

size_t plan_placing(bool probes, const PointCloud& cloud) {
  // While the cloud is there also the direction as found and where sorted samples came from.
  const size_t sorted_bytes = kept_bytes(cloud) + sizeof(uint32_t) * cloud.size();
  // The probe holds the folds, and one of two sorted.
  const size_t probing_bytes = sizeof(uint8_t) * cloud.size() + sorted_bytes / 2;
  return base_bytes + cloud_bytes(cloud) + sizeof(Vec3f) * cloud.size() + sorted_bytes + (probes ? probing_bytes : 0);
}

MemoryPlan plan_memory(Method method, bool probes, bool is_refined, const PointCloud& cloud, AfterPlacing after,
                       const Lattice& lattice, size_t support_bricks) {
  MemoryPlan plan;
  plan.placing_bytes = plan_placing(probes, cloud);
  const bool keeps = after == AfterPlacing::kept || method == Method::vrip;
  plan.fixed_bytes = base_bytes + kept_bytes(cloud) + (keeps ? cloud_bytes(cloud) : 0);
  const double per_brick = band_bytes_per_brick(method) + data_brick_bytes;
  plan.grid_bytes = box_bytes(method, lattice) + static_cast<size_t>(static_cast<double>(support_bricks) * per_brick);
  if (!is_refined) return plan;

  const size_t cells = std::min(cloud.size(), refined_cells_per_brick * support_bricks);
  const size_t refine_grid = refined_brick_bytes * support_bricks + refined_cell_bytes * cells;
  plan.grid_bytes = std::max(plan.grid_bytes, refine_grid);
  return plan;
}

MemoryPlan plan_tables(Method method, const Lattice& lattice) { return {base_bytes, box_bytes(method, lattice), 0}; }

Room::Room(std::optional<size_t> limit, size_t held) : what(limit ? "--memory" : "free memory") {
  const size_t available = available_memory_bytes();
  bytes = limit ? *limit : available > SIZE_MAX - held ? SIZE_MAX : available + held;
}

void check_memory(const MemoryPlan& plan, const Room& room, const Lattice& lattice) {
  const size_t needed = plan.total();
  if (needed <= room.bytes) return;
  const int longest = std::max({lattice.size.x, lattice.size.y, lattice.size.z});
  const int around = 2 * lattice.padding;
  const double left = room.bytes > plan.fixed_bytes ? static_cast<double>(room.bytes - plan.fixed_bytes) : 0;
  const double shrink = std::sqrt(0.8 * left / static_cast<double>(plan.grid_bytes));
  const int fits = around + static_cast<int>((longest - around) * shrink);
  throw MemoryError(
      fmt::format("memory: resolution {} needs about {}, {} is {}; {}", longest, format_bytes(needed), room.what,
                  format_bytes(room.bytes),
                  fits > around ? fmt::format("a resolution of about {} would fit", fits) : "no resolution would fit"));
}

void check_placing(size_t placing_bytes, const Room& room, size_t samples) {
  if (placing_bytes > room.bytes)
    throw MemoryError(fmt::format("memory: {} samples need about {}, {} is {}; no resolution would fit", samples,
                                  format_bytes(placing_bytes), room.what, format_bytes(room.bytes)));
}

}  // namespace soapfilm
