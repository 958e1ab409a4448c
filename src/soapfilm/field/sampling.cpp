// A sample's companions in a cell are the other samples on the piece of surface that the cell cuts out. That piece is
// chosen by its area, as samples are, so its mean area is that of a plane's section through a uniform point.
#include "soapfilm/field/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/radix_sort.h"

namespace soapfilm {

namespace {

/// Cells of a grid of 2^depth cells along the longest axis, as interleaved keys: the key of the coarser cell that holds
/// it is the key without its last three bits.
constexpr int deepest = 16;
constexpr int coarsest = 1;
constexpr double companions_wanted = 4;
/// Mean area of a plane's section with a unit cube, over planes through uniform points in uniform directions.
constexpr double mean_section = 0.9413;

uint64_t spread_bits(uint64_t v) {
  v &= 0x1FFFFF;
  v = (v | v << 32) & 0x1F00000000FFFFull;
  v = (v | v << 16) & 0x1F0000FF0000FFull;
  v = (v | v << 8) & 0x100F00F00F00F00Full;
  v = (v | v << 4) & 0x10C30C30C30C30C3ull;
  v = (v | v << 2) & 0x1249249249249249ull;
  return v;
}

/// A cell that holds samples.
struct Cell {
  uint64_t key;
  uint32_t samples;
};

std::vector<Cell> cells_of(const std::vector<uint64_t>& sorted_keys) {
  size_t count = 0;
  for (size_t i = 0; i < sorted_keys.size(); ++i) count += i == 0 || sorted_keys[i] != sorted_keys[i - 1];
  std::vector<Cell> cells;
  cells.reserve(count);
  for (const uint64_t key : sorted_keys) {
    if (!cells.empty() && cells.back().key == key)
      ++cells.back().samples;
    else
      cells.push_back({key, 1});
  }
  return cells;
}

std::vector<Cell> occupied_cells(std::span<const Vec3d> positions, const Box3d& box, int depth) {
  const double longest = box.longest(), cells = static_cast<double>(1 << deepest);
  std::vector<uint64_t> keys;
  reserve_many(keys, positions.size());
  for (const Vec3d& p : positions) {
    uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::min((p[axis] - box.lo[axis]) / longest * cells, cells - 1);
      key |= spread_bits(static_cast<uint64_t>(cell) >> (deepest - depth)) << axis;
    }
    keys.push_back(key);
  }
  radix_sort(keys, 3 * depth);
  return cells_of(keys);
}

/// The occupied cells one depth less deep.
void coarsen(std::vector<Cell>& cells) {
  size_t kept = 0;
  for (size_t i = 0; i < cells.size(); ++i) {
    const Cell cell{cells[i].key >> 3, cells[i].samples};
    if (kept > 0 && cells[kept - 1].key == cell.key)
      cells[kept - 1].samples += cell.samples;
    else
      cells[kept++] = cell;
  }
  cells.resize(kept);
}

double pairs_of(const Cell& cell) {
  return static_cast<double>(cell.samples) * (static_cast<double>(cell.samples) - 1);
}

/// Other samples in a sample's cell, averaged over the samples.
double mean_companions(const std::vector<Cell>& cells, size_t samples) {
  double pairs = 0;
  for (const Cell& cell : cells) pairs += pairs_of(cell);
  return pairs / static_cast<double>(samples);
}

/// The cells at the scale where the density shows.
struct Scale {
  int depth = coarsest;
  double companions = 0;
  double crowded = 0;  ///< those in the fullest cell, as its share of `companions`
};

Scale find_scale(std::span<const Vec3d> positions, const Box3d& box) {
  // A surface has about 4^depth cells: at this depth mostly less than one sample for each, so few companions.
  int depth = coarsest;
  while (depth < deepest && size_t{1} << (2 * depth) < positions.size()) ++depth;
  std::vector<Cell> occupied = occupied_cells(positions, box, depth);
  while (depth < deepest && mean_companions(occupied, positions.size()) >= companions_wanted)
    occupied = occupied_cells(positions, box, depth = std::min(depth + 2, deepest));
  for (;; --depth, coarsen(occupied)) {
    const double companions = mean_companions(occupied, positions.size());
    if (companions < companions_wanted && depth > coarsest) continue;
    double most = 0;
    for (const Cell& cell : occupied) most = std::max(most, pairs_of(cell));
    return {depth, companions, companions > 0 ? most / (companions * static_cast<double>(positions.size())) : 0};
  }
}

/// Whether samples at one place may be what was measured: then companions stay down to the finest cells, or one cell
/// holds many of them.
bool may_repeat(const Scale& scale) {
  constexpr double many = 0.25;
  return scale.depth == deepest || scale.crowded > many;
}

/// Each place once; tells how many samples that leaves out, and where most of them are.
std::vector<Vec3d> places_of(std::vector<Vec3d> positions, Sampling& sampling) {
  const auto before = [](const Vec3d& a, const Vec3d& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  std::sort(positions.begin(), positions.end(), before);
  size_t kept = 0, most = 0;
  for (size_t begin = 0, end = 0; begin < positions.size(); begin = end) {
    while (end < positions.size() && positions[end] == positions[begin]) ++end;
    if (end - begin > most) sampling.most_repeated = positions[begin];
    most = std::max(most, end - begin);
    positions[kept++] = positions[begin];
  }
  sampling.repeats = positions.size() - kept;
  positions.resize(kept);
  return positions;
}

}  // namespace

double Sampling::voxel(double density) const { return per_area > 0 ? std::sqrt(density / per_area) : 0; }

Sampling measure_sampling(const PointCloud& cloud) {
  const Box3d box = cloud.box();
  const double longest = box.longest();
  Sampling sampling;
  if (!(longest > 0)) return sampling;
  Scale scale = find_scale(cloud.positions, box);
  if (may_repeat(scale)) {
    const std::vector<Vec3d> places = places_of(cloud.positions, sampling);
    if (sampling.repeats > 0) scale = find_scale(places, box);
  }
  const double cell = longest / static_cast<double>(1 << scale.depth);
  sampling.per_area = scale.companions / (mean_section * cell * cell);
  return sampling;
}

}  // namespace soapfilm
