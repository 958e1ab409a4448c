// The samples as the grid sees them: in lattice coordinates, sorted by brick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// Samples grouped by the brick that holds them; within a brick in the order of the cloud, so that sums over them
/// never depend on threads. Positions are relative to the brick: float keeps 2^-21 voxel wherever the brick is.
struct GridSamples {
  BrickGrid bricks;              ///< the bricks that hold at least one sample
  int turn = 0;                  ///< of the lattice's axes
  std::vector<uint32_t> begin;   ///< brick b holds samples [begin[b], begin[b + 1])
  std::vector<Vec3f> local;      ///< position relative to the brick's first vertex, voxels, each in [0, 8)
  std::vector<Vec3f> direction;  ///< weak outward direction along the lattice's axes, as long as the sample counts in
                                 ///< the data term: its weight, times that of the area it stands for
  std::vector<float> weight;     ///< as the cloud gives it, > 0; empty: all are 1
  std::vector<uint32_t> source;  ///< index of the sample in the cloud; dropped once nobody asks the cloud any more
  std::vector<uint8_t> sample_hash;  ///< random bits for each, the same wherever the grid lies: sample_hash_of(source)

  size_t size() const { return local.size(); }
  float weight_of(size_t s) const { return weight.empty() ? 1.0f : weight[s]; }
};

/// Lattice coordinates of each sample, in their order.
std::vector<Vec3d> lattice_positions(const GridSamples& samples);

/// Samples of a cloud: their indices have 32 bits.
inline constexpr size_t most_samples = UINT32_MAX;

/// Has the sample a direction and a weight > 0?
inline bool takes_part(const PointCloud& cloud, std::span<const Vec3f> directions, size_t i) {
  return directions[i] != Vec3f{} && (cloud.weights.empty() || cloud.weights[i] > 0);
}

/// What decides a sample's part where some of them are held out.
uint8_t sample_hash_of(size_t source);

/// Sorts the cloud's samples into bricks. `directions` is as long as the cloud; samples with a zero direction say
/// nothing and are left out, and so are those that are not `wanted`, where that is given.
GridSamples sort_samples(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& lattice,
                         const Context& context, const std::function<bool(size_t)>& wanted = {});

}  // namespace soapfilm
