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
constexpr size_t base_bytes = size_t{24} << 20;

/// A brick of a level: u and p, the layers that a sweep leaves behind, rim fluxes (about one face in three), topology
/// twice (band and support).
constexpr size_t level_brick_bytes = brick_volume * 4 * sizeof(float) + 3 * brick_area * sizeof(float) +
                                     brick_area * sizeof(float) + 2 * (sizeof(Vec3i) + sizeof(BrickGrid::Neighbors)) +
                                     128;
constexpr size_t data_brick_bytes = brick_volume * sizeof(float);

/// Beyond the support bricks a band holds what closes holes: measured 1.02 to 1.15 times as many.
constexpr double band_over_support = 1.1;
/// A level beside its coarser one, and all data terms: surfaces shrink by 4 per level, small levels a little less, and
/// coarser bands are wider.
constexpr double coarser_share = 0.35;
constexpr double coarser_data_share = 0.4;

size_t table_bytes(const Lattice& lattice) {
  const Vec3i bricks = lattice.box(0).bricks;
  const double bits = static_cast<double>(bricks.x) * bricks.y * bricks.z;
  constexpr double masks = 6;  // support, band, inside; each beside its coarser or older one
  return static_cast<size_t>(masks * bits / 8);
}

}  // namespace

MemoryPlan plan_memory(const PointCloud& cloud, const Lattice& lattice, size_t support_bricks) {
  MemoryPlan plan;
  size_t per_sample = sizeof(Vec3d) + sizeof(Vec3f);   // position and direction
  per_sample += 2 * sizeof(Vec3f) + sizeof(uint32_t);  // sorted position, direction, source
  if (!cloud.normals.empty()) per_sample += sizeof(Vec3f);
  if (!cloud.sensors.empty()) per_sample += sizeof(Vec3d);
  if (!cloud.weights.empty()) per_sample += sizeof(float);
  if (!cloud.colors.empty()) per_sample += sizeof(Rgb8);
  plan.fixed_bytes = base_bytes + per_sample * cloud.size();
  for (const Scan& scan : cloud.scans)
    if (scan.range_grid) plan.fixed_bytes += scan.range_grid->sample.size() * sizeof(int32_t);

  const auto bricks = static_cast<double>(support_bricks);
  plan.grid_bytes =
      table_bytes(lattice) + static_cast<size_t>(bricks * (band_over_support * (1 + coarser_share) * level_brick_bytes +
                                                           (1 + coarser_data_share) * data_brick_bytes));
  return plan;
}

MemoryPlan plan_tables(const Lattice& lattice) { return {base_bytes, table_bytes(lattice)}; }

void check_memory(const MemoryPlan& plan, std::optional<size_t> limit, size_t held, const Lattice& lattice) {
  const size_t available = available_memory_bytes();
  const size_t free = limit ? *limit : available > SIZE_MAX - held ? SIZE_MAX : available + held;
  const size_t needed = plan.total();
  if (needed <= free) return;
  const int longest = std::max({lattice.size.x, lattice.size.y, lattice.size.z});
  const int around = 2 * lattice.padding;
  const double left = free > plan.fixed_bytes ? static_cast<double>(free - plan.fixed_bytes) : 0;
  const double shrink = std::sqrt(0.85 * left / static_cast<double>(plan.grid_bytes));
  const int fits = around + static_cast<int>((longest - around) * shrink);
  throw MemoryError(
      fmt::format("memory: resolution {} needs about {}, {} is {}; {}", longest, format_bytes(needed),
                  limit ? "--memory" : "free memory", format_bytes(free),
                  fits > around ? fmt::format("a resolution of about {} would fit", fits) : "no resolution would fit"));
}

}  // namespace soapfilm
