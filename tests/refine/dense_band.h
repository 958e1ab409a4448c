// A small band's vertices in a plain list, and what is done on it written as simply as possible: the reference of the
// loops over rows. All in double.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "refine/band_support.h"
#include "soapfilm/refine/fit/narrow_band.h"

namespace soapfilm::test {

using Values = std::vector<double>;

struct DenseBand {
  std::vector<Vec3i> vertex;
  std::vector<size_t> slot;  ///< in arrays over the band
  std::map<std::tuple<int, int, int>, size_t> index;
  std::vector<std::vector<size_t>> around;  ///< each one's neighbors

  explicit DenseBand(const NarrowBand& band) {
    for_each_vertex(band, [&](Vec3i v, size_t i) {
      index[{v.z, v.y, v.x}] = vertex.size();
      vertex.push_back(v);
      slot.push_back(i);
    });
    around.resize(size());
    for (size_t i = 0; i < size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        for (const size_t j : neighbors(i, axis)) around[i].push_back(j);
  }

  size_t size() const { return vertex.size(); }
  std::optional<size_t> find(Vec3i v) const {
    const auto found = index.find({v.z, v.y, v.x});
    return found == index.end() ? std::nullopt : std::optional(found->second);
  }
  Values values(const RowArray& array) const {
    Values out;
    for (const size_t i : slot) out.push_back(static_cast<double>(array.data()[i]));
    return out;
  }
  RowArray array(const NarrowBand& band, const Values& values) const {
    RowArray out = band.make_array();
    for (size_t i = 0; i < size(); ++i) out.data()[slot[i]] = static_cast<float>(values[i]);
    return out;
  }
  /// The neighbors at -step and +step along an axis that are in the band.
  std::vector<size_t> neighbors(size_t i, int axis) const {
    std::vector<size_t> found;
    for (const Vec3i next : {vertex[i] - along(axis), vertex[i] + along(axis)})
      if (const auto j = find(next)) found.push_back(*j);
    return found;
  }
  const std::vector<size_t>& neighbors(size_t i) const { return around[i]; }

  /// Sum over the neighbors of x_i - x_j.
  Values graph_laplacian(const Values& x) const {
    Values out(size());
    for (size_t i = 0; i < size(); ++i)
      for (const size_t j : neighbors(i)) out[i] += x[i] - x[j];
    return out;
  }
  /// Second differences, summed over the axes on which both neighbors are in the band.
  Values inner_laplacian(const Values& x) const {
    Values out(size());
    for (size_t i = 0; i < size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        if (const auto pair = neighbors(i, axis); pair.size() == 2) out[i] += x[pair[0]] + x[pair[1]] - 2 * x[i];
    return out;
  }
};

/// Trilinear interpolation from a band of half the resolution, whose vertex I lies on vertex 2 I, and its transpose.
struct DenseTransfer {
  struct Share {
    size_t fine, coarse;
    double weight;
  };
  std::vector<Share> shares;

  /// Every coarse vertex from which a fine one interpolates must be in the coarse band.
  DenseTransfer(const DenseBand& fine, const DenseBand& coarse) {
    for (size_t i = 0; i < fine.size(); ++i)
      for (int corner = 0; corner < 8; ++corner) {
        Vec3i from;
        double weight = 1;
        for (int axis = 0; axis < 3 && weight > 0; ++axis) {
          const int v = fine.vertex[i][axis], odd = v & 1, upper = corner >> axis & 1;
          from[axis] = (v - odd) / 2 + upper;
          weight *= odd ? 0.5 : 1.0 - upper;
        }
        if (weight > 0) shares.push_back({i, coarse.find(from).value(), weight});
      }
  }
  Values up(const Values& coarse, size_t fine_size) const {
    Values out(fine_size);
    for (const Share& s : shares) out[s.fine] += s.weight * coarse[s.coarse];
    return out;
  }
  Values down(const Values& fine, size_t coarse_size) const {
    Values out(coarse_size);
    for (const Share& s : shares) out[s.coarse] += s.weight * fine[s.fine];
    return out;
  }
};

/// The mean of values / weights around each vertex, as Multilevel::local_mean() describes it: variance 3 voxels^2, of
/// which restriction and interpolation are one and diffusion on the coarser band is the rest.
inline Values slow_local_mean(const DenseBand& fine, const DenseBand& coarse, const Values& values,
                              const Values& weights) {
  const DenseTransfer transfer(fine, coarse);
  const auto spread = [&](const Values& from) {
    Values sums = transfer.down(from, coarse.size());
    for (int pass = 0; pass < 2; ++pass) {
      const Values rough = coarse.graph_laplacian(sums);
      for (size_t i = 0; i < sums.size(); ++i) sums[i] -= rough[i] / 8;  // a coarse step is two voxels: one voxel^2
    }
    return sums;
  };
  const Values sums = spread(values), totals = spread(weights);
  Values mean(coarse.size());
  for (size_t i = 0; i < mean.size(); ++i) mean[i] = totals[i] > 0 ? sums[i] / totals[i] : 0;
  return transfer.up(mean, fine.size());
}

/// A plane that lies along no axis.
inline double sheet_distance(Vec3d q) { return 0.36 * (q.x - 8) + 0.48 * (q.y - 7) + 0.8 * (q.z - 7.5); }
/// `half` voxels on either side of it in a box of 2^3 bricks, 12 voxels wide; a share of the vertices is missing.
inline NarrowBand sheet_band(double half, double missing, uint64_t seed) {
  constexpr int begin = 2, end = 14;
  const Context context(1);
  BrickGrid grid(BrickMask::whole({2, 2, 2}), context);
  Random random(seed);
  std::vector<uint8_t> vertices(grid.size() * brick_area);
  for (size_t b = 0; b < grid.size(); ++b)
    for_each_vertex(grid.coord(b), [&](Vec3i v, int i) {
      if (std::min(v.x, v.y) >= begin && std::max(v.x, v.y) < end && std::abs(sheet_distance(Vec3d(v))) < half &&
          random.uniform() >= missing)
        vertices[b * brick_area + static_cast<size_t>(i / brick_side)] |= static_cast<uint8_t>(1 << (i % brick_side));
    });
  return NarrowBand(std::move(grid), vertices, context);
}

}  // namespace soapfilm::test
