#include "soapfilm/field/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace soapfilm {

namespace {

/// Cells of a grid of 2^depth cells along the longest axis, as interleaved keys: the key of the coarser cell that holds
/// it is the key without its last three bits.
constexpr int deepest = 16;
constexpr int coarsest = 2;
constexpr size_t samples_per_cell = 12;
/// Cells with fewer hold outliers, not surface.
constexpr size_t least_samples = 3;
/// A plane of random orientation crosses 1.5 cells per area of a cell's face.
constexpr double cells_per_face_area = 1.5;

uint64_t spread_bits(uint64_t v) {
  v &= 0x1FFFFF;
  v = (v | v << 32) & 0x1F00000000FFFFull;
  v = (v | v << 16) & 0x1F0000FF0000FFull;
  v = (v | v << 8) & 0x100F00F00F00F00Full;
  v = (v | v << 4) & 0x10C30C30C30C30C3ull;
  v = (v | v << 2) & 0x1249249249249249ull;
  return v;
}

struct Occupancy {
  size_t cells = 0;
  size_t samples = 0;
};

/// Cells with at least `least_samples`, at the scale where keys differ above the lowest `shift` bits.
Occupancy count_cells(const std::vector<uint64_t>& sorted_keys, int shift) {
  Occupancy o;
  for (size_t begin = 0, end = 0; begin < sorted_keys.size(); begin = end) {
    while (end < sorted_keys.size() && (sorted_keys[end] >> shift) == (sorted_keys[begin] >> shift)) ++end;
    if (end - begin < least_samples) continue;
    ++o.cells;
    o.samples += end - begin;
  }
  return o;
}

}  // namespace

double Sampling::voxel(double density) const {
  return samples > 0 ? std::sqrt(density * area / static_cast<double>(samples)) : 0;
}

Sampling measure_sampling(const PointCloud& cloud) {
  const Box3d box = cloud.box();
  const double longest = box.longest();
  Sampling sampling;
  sampling.samples = cloud.size();
  if (!(longest > 0)) return sampling;

  const double cells = static_cast<double>(1 << deepest);
  std::vector<uint64_t> keys;
  keys.reserve(cloud.size());
  for (const Vec3d& p : cloud.positions) {
    uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::min((p[axis] - box.lo[axis]) / longest * cells, cells - 1);
      key |= spread_bits(static_cast<uint64_t>(cell)) << axis;
    }
    keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  for (int depth = deepest; depth >= coarsest; --depth) {
    const Occupancy o = count_cells(keys, 3 * (deepest - depth));
    if (o.samples < samples_per_cell * o.cells && depth > coarsest) continue;
    const double cell = longest / static_cast<double>(1 << depth);
    sampling.area = static_cast<double>(o.cells) * cell * cell / cells_per_face_area;
    sampling.samples = o.samples;
    if (o.cells > 0) break;
  }
  return sampling;
}

}  // namespace soapfilm
