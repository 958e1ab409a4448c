// A sample's companions in a cell are the other samples on the piece of surface that the cell cuts out. That piece is
// chosen by its area, as samples are, so its mean area is that of a plane's section through a uniform point.
#include "soapfilm/field/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/radix_sort.h"

namespace soapfilm {

namespace {

/// Cells of a grid of 2^depth cells along the longest axis, as interleaved keys: the key of the coarser cell that holds
/// it is the key without its last three bits.
constexpr int deepest = 16;
constexpr int coarsest = 1;
constexpr double companions_wanted = 4;
constexpr size_t samples_per_task = size_t{1} << 15;
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

/// The keys of the cells that hold the samples, sorted.
std::vector<uint64_t> cells_of(const PointCloud& cloud, const Box3d& box, int depth, const Parallel& parallel) {
  const double longest = box.longest(), cells = static_cast<double>(1 << deepest);
  std::vector<uint64_t> keys;
  reserve_many(keys, cloud.size());
  keys.resize(cloud.size());
  parallel.for_each(cloud.size(), samples_per_task, [&](size_t i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::min((cloud.positions[i][axis] - box.lo[axis]) / longest * cells, cells - 1);
      keys[i] |= spread_bits(static_cast<uint64_t>(cell) >> (deepest - depth)) << axis;
    }
  });
  radix_sort(keys, 3 * depth, parallel);
  return keys;
}

/// Other samples in a sample's cell, averaged over the samples; cells are `up` depths less deep than the sorted keys
/// say. A run of samples is counted by the chunk that it begins in.
double mean_companions(const std::vector<uint64_t>& keys, int up, const Parallel& parallel) {
  const auto cell = [&](size_t i) { return keys[i] >> (3 * up); };
  const auto pairs = sum_chunks<uint64_t>(keys.size(), samples_per_task, parallel, [&](size_t begin, size_t end) {
    uint64_t found = 0;
    while (begin > 0 && begin < end && cell(begin) == cell(begin - 1)) ++begin;
    while (begin < end) {
      size_t next = begin + 1;
      while (next < keys.size() && cell(next) == cell(begin)) ++next;
      found += (next - begin) * (next - begin - 1);
      begin = next;
    }
    return found;
  });
  return static_cast<double>(pairs) / static_cast<double>(keys.size());
}

}  // namespace

double Sampling::voxel(double density) const { return per_area > 0 ? std::sqrt(density / per_area) : 0; }

Sampling measure_sampling(const PointCloud& cloud, const Parallel& parallel) {
  const Box3d box = cloud.box(parallel);
  const double longest = box.longest();
  Sampling sampling;
  if (!(longest > 0)) return sampling;

  // A surface has about 4^depth cells: at this depth mostly less than one sample for each, so few companions.
  int depth = coarsest;
  while (depth < deepest && size_t{1} << (2 * depth) < cloud.size()) ++depth;
  std::vector<uint64_t> keys = cells_of(cloud, box, depth, parallel);
  while (depth < deepest && mean_companions(keys, 0, parallel) >= companions_wanted) {
    release(keys);
    keys = cells_of(cloud, box, depth = std::min(depth + 2, deepest), parallel);
  }
  for (int up = 0;; ++up) {
    const double companions = mean_companions(keys, up, parallel);
    if (companions < companions_wanted && depth - up > coarsest) continue;
    const double cell = longest / static_cast<double>(1 << (depth - up));
    sampling.per_area = companions / (mean_section * cell * cell);
    return sampling;
  }
}

}  // namespace soapfilm
