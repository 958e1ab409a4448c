#include "soapfilm/field/samples.h"

#include <climits>
#include <cmath>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/random.h"

namespace soapfilm {

namespace {

Vec3i brick_at(Vec3d lattice_position) {
  return brick_of({static_cast<int>(std::floor(lattice_position.x)), static_cast<int>(std::floor(lattice_position.y)),
                   static_cast<int>(std::floor(lattice_position.z))});
}

}  // namespace

uint8_t lot_of(size_t source) {
  constexpr uint64_t stride = 0x51ED2700;  // between seeds
  return static_cast<uint8_t>(Random(1 + stride * (source + 1)).next() >> 11);
}

GridSamples sort_samples(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& lattice,
                         const Parallel& parallel, const std::function<bool(size_t)>& wanted) {
  constexpr size_t grain = 1 << 14;
  constexpr int32_t none = -1;
  const size_t n = cloud.size();
  const auto takes = [&](size_t i) { return speaks(cloud, directions, i) && (!wanted || wanted(i)); };
  GridSamples samples;

  // Neighbours in a scan mostly share a brick: it is looked up where it changes.
  constexpr Vec3i nowhere{INT_MIN, INT_MIN, INT_MIN};
  BrickMask occupied(lattice.box(0).bricks);
  Vec3i last = nowhere;
  for (size_t i = 0; i < n; ++i) {
    if (!takes(i)) continue;
    const Vec3i brick = brick_at(lattice.to_lattice(cloud.positions[i]));
    if (!(brick == last)) occupied.set(last = brick);
  }
  samples.bricks = BrickGrid(occupied, parallel);

  // A counting sort: stable, so the order within a brick is the cloud's.
  std::vector<int32_t> holder(n);
  parallel.for_chunks(n, grain, [&](size_t begin, size_t end) {
    Vec3i found = nowhere;
    int32_t index = none;
    for (size_t i = begin; i < end; ++i) {
      holder[i] = none;
      if (!takes(i)) continue;
      const Vec3i brick = brick_at(lattice.to_lattice(cloud.positions[i]));
      if (!(brick == found)) index = samples.bricks.find(found = brick);
      holder[i] = index;
    }
  });
  samples.begin.assign(samples.bricks.size() + 1, 0);
  for (const int32_t b : holder)
    if (b != none) ++samples.begin[static_cast<size_t>(b) + 1];
  for (size_t b = 0; b < samples.bricks.size(); ++b) samples.begin[b + 1] += samples.begin[b];
  samples.source.resize(samples.begin.back());
  std::vector<uint32_t> next(samples.begin.begin(), samples.begin.end() - 1);
  for (size_t i = 0; i < n; ++i)
    if (holder[i] != none) samples.source[next[static_cast<size_t>(holder[i])]++] = static_cast<uint32_t>(i);
  release(holder);

  samples.local.resize(samples.source.size());
  samples.direction.resize(samples.source.size());
  samples.lot.resize(samples.source.size());
  parallel.for_each(samples.source.size(), grain, [&](size_t k) {
    const size_t i = samples.source[k];
    const Vec3d position = lattice.to_lattice(cloud.positions[i]);
    samples.local[k] = Vec3f(position - Vec3d(brick_at(position) * brick_side));
    samples.direction[k] = cloud.weights.empty() ? directions[i] : directions[i] * cloud.weights[i];
    samples.lot[k] = lot_of(i);
  });
  return samples;
}

}  // namespace soapfilm
