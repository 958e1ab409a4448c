// A sample's companions in a cell are the other samples on the piece of surface that the cell cuts out. That piece is
// chosen by its area, as samples are, so its mean area is that of a plane's section through a uniform point.
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

/// Other samples in a sample's cell, averaged over the samples, where keys differ above the lowest `shift` bits.
double mean_companions(const std::vector<uint64_t>& sorted_keys, int shift) {
  double pairs = 0;
  for (size_t begin = 0, end = 0; begin < sorted_keys.size(); begin = end) {
    while (end < sorted_keys.size() && (sorted_keys[end] >> shift) == (sorted_keys[begin] >> shift)) ++end;
    const auto count = static_cast<double>(end - begin);
    pairs += count * (count - 1);
  }
  return pairs / static_cast<double>(sorted_keys.size());
}

}  // namespace

double Sampling::voxel(double density) const { return per_area > 0 ? std::sqrt(density / per_area) : 0; }

Sampling measure_sampling(const PointCloud& cloud) {
  const Box3d box = cloud.box();
  const double longest = box.longest();
  Sampling sampling;
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
    const double companions = mean_companions(keys, 3 * (deepest - depth));
    if (companions < companions_wanted && depth > coarsest) continue;
    const double cell = longest / static_cast<double>(1 << depth);
    sampling.per_area = companions / (mean_section * cell * cell);
    break;
  }
  return sampling;
}

}  // namespace soapfilm
