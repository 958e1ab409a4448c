// The other samples in a sample's cell lie on the piece of surface inside that cell. The piece is chosen by its area,
// as samples are, so its mean area is that of a plane's section through a uniform point.
#include "soapfilm/field/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/morton.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/radix_sort.h"

namespace soapfilm {

namespace {

/// Cells of a grid of 2^depth cells along the longest axis, as interleaved keys: the key of the coarser cell around a
/// cell is the key without its last three bits.
constexpr int deepest = 16;
constexpr int coarsest = 1;
constexpr double companions_wanted = 4;
constexpr size_t keys_per_task = size_t{1} << 15;
/// Mean area of a plane's section with a unit cube, over planes through uniform points in uniform directions.
constexpr double mean_section = 0.9413;

/// The keys of the cells that hold the samples, sorted.
std::vector<uint64_t> cells_of(std::span<const Vec3d> positions, const Box3d& box, int depth, const Context& context) {
  const double longest = box.longest();
  std::vector<uint64_t> keys;
  reserve_many(keys, positions.size());
  keys.resize(positions.size());
  parallel_for(context, positions.size(), keys_per_task, [&](size_t i) {
    keys[i] = morton_key((positions[i] - box.lo) / longest, deepest) >> (3 * (deepest - depth));
  });
  radix_sort(keys, 3 * depth, context);
  return keys;
}

/// Ordered pairs of samples in the same cell.
struct Pairs {
  uint64_t all = 0;
  uint64_t most = 0;  ///< in one cell

  void operator+=(const Pairs& p) {
    all += p.all;
    most = std::max(most, p.most);
  }
  /// Other samples in a sample's cell, averaged over the samples.
  double companions(size_t samples) const { return static_cast<double>(all) / static_cast<double>(samples); }
};

/// Cells `up` levels coarser than those of the sorted keys. A run of samples is counted by the chunk in which it
/// begins.
Pairs count_pairs(const std::vector<uint64_t>& keys, int up, const Context& context) {
  const auto shares_cell = [&](size_t i) { return keys[i] >> (3 * up) == keys[i - 1] >> (3 * up); };
  return sum_chunks<Pairs>(keys.size(), keys_per_task, context, [&](size_t begin, size_t end) {
    while (begin > 0 && begin < end && shares_cell(begin)) ++begin;
    Pairs found;
    uint64_t before = 0;  // in the same cell
    const auto count = [&] {
      found.all += 2 * before;
      found.most = std::max(found.most, before);
    };
    for (size_t i = begin + 1; i < end; ++i) {  // runs are short, and their ends cannot be predicted: no branch on them
      before = (before + 1) & -uint64_t{shares_cell(i)};
      count();
    }
    for (size_t i = end; begin < end && i < keys.size() && shares_cell(i); ++i) {
      ++before;
      count();
    }
    found.most *= found.most + 1;
    return found;
  });
}

/// The cells at the scale where the density is measured.
struct Scale {
  int depth = coarsest;
  double companions = 0;
  double crowded = 0;  ///< the samples in the fullest cell, as a share of `companions`
};

Scale find_scale(std::span<const Vec3d> positions, const Box3d& box, const Context& context) {
  // A surface has about 4^depth cells: at this depth mostly less than one sample each, so few other samples per cell.
  int depth = coarsest;
  while (depth < deepest && size_t{1} << (2 * depth) < positions.size()) ++depth;
  std::vector<uint64_t> keys = cells_of(positions, box, depth, context);
  Pairs pairs = count_pairs(keys, 0, context);
  const auto enough = [&] { return pairs.companions(positions.size()) >= companions_wanted; };
  while (depth < deepest && enough()) {
    release(keys);
    keys = cells_of(positions, box, depth = std::min(depth + 2, deepest), context);
    pairs = count_pairs(keys, 0, context);
  }
  int up = 0;
  while (depth - up > coarsest && !enough()) pairs = count_pairs(keys, ++up, context);
  return {depth - up, pairs.companions(positions.size()),
          pairs.all > 0 ? static_cast<double>(pairs.most) / static_cast<double>(pairs.all) : 0};
}

/// Whether many samples may be at one place: then pairs remain down to the finest cells, or one cell holds many
/// samples.
bool may_repeat(const Scale& scale) {
  constexpr double many = 0.25;
  return scale.depth == deepest || scale.crowded > many;
}

/// Each place once; stores how many samples that leaves out, and where most of them are.
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

Sampling measure_sampling(const PointCloud& cloud, const Context& context) {
  return measure_sampling(cloud, cloud.box(context), context);
}

Sampling measure_sampling(const PointCloud& cloud, const Box3d& box, const Context& context) {
  const double longest = box.longest();
  Sampling sampling;
  if (!(longest > 0)) return sampling;
  Scale scale = find_scale(cloud.positions, box, context);
  if (may_repeat(scale)) {
    const std::vector<Vec3d> places = places_of(cloud.positions, sampling);
    if (sampling.repeats > 0) scale = find_scale(places, box, context);
  }
  const double cell = longest / static_cast<double>(1 << scale.depth);
  sampling.per_area = scale.companions / (mean_section * cell * cell);
  return sampling;
}

ThinnedSampling measure_thinned(const PointCloud& cloud, const Box3d& box, const Context& context) {
  constexpr size_t fewest = 64;          // kept samples whose density means something
  constexpr size_t several = 4;          // samples in a cell
  constexpr double clearly_apart = 1.6;  // voxel of one sample each, cells
  ThinnedSampling thinned;
  const double longest = box.longest();
  if (!(longest > 0)) return thinned;
  using Keyed = std::pair<uint64_t, uint32_t>;
  std::vector<Keyed> order(cloud.size());
  parallel_for(context, order.size(), keys_per_task, [&](size_t i) {
    order[i] = {morton_key((cloud.positions[i] - box.lo) / longest, deepest), static_cast<uint32_t>(i)};
  });
  std::sort(order.begin(), order.end());
  PointCloud kept;
  for (int depth = coarsest; depth <= deepest; ++depth) {
    context.check();
    const int up = 3 * (deepest - depth);
    const auto shares_cell = [&](size_t k) { return k > 0 && order[k].first >> up == order[k - 1].first >> up; };
    kept.positions.clear();
    for (size_t k = 0; k < order.size(); ++k)
      if (!shares_cell(k)) kept.positions.push_back(cloud.positions[order[k].second]);
    if (kept.size() < fewest) continue;
    const Sampling sampling = measure_sampling(kept, box, context);
    if (sampling.voxel(1) < clearly_apart * longest / static_cast<double>(1 << depth)) continue;
    thinned.sampling = sampling;
    thinned.weights.resize(cloud.size());
    for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
      for (++end; end < order.size() && shares_cell(end);) ++end;
      for (size_t k = begin; k < end; ++k) thinned.weights[order[k].second] = 1.0f / static_cast<float>(end - begin);
      thinned.crowded += end - begin > several;
    }
    thinned.crowded /= static_cast<double>(kept.size());
    return thinned;
  }
  return thinned;
}

}  // namespace soapfilm
