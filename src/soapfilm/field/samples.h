// The samples on the grid: in lattice coordinates, sorted by brick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// Samples grouped by the brick that holds them, within a brick sorted by their places: sums depend neither on threads
/// nor on the order of the cloud. Positions are relative to the brick: float has a resolution of 2^-21 voxel in every
/// brick.
struct GridSamples {
  BrickGrid bricks;                  ///< the bricks that hold at least one sample
  int axis_shift = 0;                ///< permutation of the lattice's axes
  std::vector<uint32_t> begin;       ///< brick b holds samples [begin[b], begin[b + 1])
  std::vector<Vec3f> local;          ///< position relative to the brick's first vertex, voxels, each in [0, 8)
  std::vector<Vec3f> direction;      ///< rough outward direction along the lattice's axes; its length is how strongly
                                     ///< the sample pulls in the data term: weigh_directions() alone changes it
  std::vector<float> weight;         ///< how many samples it counts as: as given in the cloud, times weight_scale();
                                     ///< > 0; empty: all are 1
  std::vector<uint32_t> source;      ///< index of the sample in the cloud; freed when the cloud is no longer needed
  std::vector<uint8_t> sample_hash;  ///< random bits of its place, the same for any grid: sample_hash_of()

  size_t size() const { return local.size(); }
  float weight_of(size_t s) const { return weight.empty() ? 1.0f : weight[s]; }

  /// Multiplies the length of each direction: by the sample's weight when it is sorted, by the area it stands for when
  /// that is known. Area is no part of `weight`: fits and counts take each sample for as many as it is.
  template <class FactorOf>
  void weigh_directions(const Context& context, FactorOf&& factor_of) {
    constexpr size_t samples_per_task = size_t{1} << 15;
    parallel_for(context, size(), samples_per_task, [&](size_t s) { direction[s] = direction[s] * factor_of(s); });
  }

  /// Other samples of the same columns: `taken` of these in their order, sorted by the bricks of `grid`, brick b having
  /// [first[b], first[b + 1]). Columns that are empty stay empty.
  GridSamples select(BrickGrid grid, std::vector<uint32_t> first, std::span<const uint32_t> taken,
                     const Context& context) const;
  /// Sorts the samples of each brick by position, then direction and weight: of equal ones the first comes first.
  void sort_by_place(const Context& context);
  /// Those of some of the bricks.
  GridSamples in(BrickGrid grid, const Context& context) const;

 private:
  /// visit(member) for every column.
  template <class Visit>
  static void for_each_column(Visit&& visit) {
    visit(&GridSamples::local);
    visit(&GridSamples::direction);
    visit(&GridSamples::weight);
    visit(&GridSamples::source);
    visit(&GridSamples::sample_hash);
  }
};

/// Lattice coordinates of each sample, in their order.
std::vector<Vec3d> lattice_positions(const GridSamples& samples);

/// Whether the sample has a direction and a weight > 0.
inline bool takes_part(const PointCloud& cloud, std::span<const Vec3f> directions, size_t i) {
  return directions[i] != Vec3f{} && (cloud.weights.empty() || cloud.weights[i] > 0);
}

/// What a cloud's weights are multiplied by. A weight of 1 is one sample; if the median of the positive ones is below
/// 0.1 or above 10 they mean something else, such as a confidence: the median then becomes 1. Throws SamplesError for a
/// weight that is negative, not finite, or more than 1e6 times the median.
double weight_scale(const PointCloud& cloud);

/// Decides which samples are held out: all at one place, or none. `box` is that of the cloud.
uint8_t sample_hash_of(Vec3d place, const Box3d& box);

/// Sorts the cloud's samples into bricks. `directions` is as long as the cloud; samples with a zero direction are left
/// out, and so are those that are not `wanted`, if that is given.
GridSamples sort_samples(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& lattice,
                         const Context& context, const std::function<bool(size_t)>& wanted = {});

}  // namespace soapfilm
