// Where triangles of about a voxel pass through each other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/core/mesh.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

/// Finds pairs of triangles that meet elsewhere than in common corners and edges, again and again while corners move.
/// Judged as count_self_intersections() does, exactly, on coordinates rounded to 2^-23 voxel.
class CrossingSearch {
 public:
  using Pair = std::array<uint32_t, 2>;  ///< triangles, the lower first

  /// Every vertex will lie between `start` and `target` (input units), on the straight line. Of each pair at least one
  /// triangle will be among those marked by `changing`. All but the places must outlive the search. Triangles are
  /// sorted into bins of two voxels: it is fast when they are about a voxel long.
  CrossingSearch(std::span<const Vec3d> start, std::span<const Vec3d> target, std::span<const Triangle> triangles,
                 std::span<const uint8_t> changing, double voxel, const Parallel& parallel);

  /// Those of which at least one triangle is marked by `changed`, each once, in an order that does not depend on the
  /// number of threads.
  std::vector<Pair> find(std::span<const Vec3d> vertices, std::span<const uint8_t> changed) const;

 private:
  struct Bin {
    size_t begin, end;  ///< of entries_
  };
  class Scratch;

  /// In voxels, all coordinates above 0.
  Vec3d place(Vec3d vertex) const { return (vertex - origin_) * per_voxel_ + Vec3d{1, 1, 1}; }
  void place_bins(std::span<const Vec3d> start, std::span<const Vec3d> target);
  uint64_t number_of(int x, int y, int z) const {
    return (static_cast<uint64_t>(z) * static_cast<uint64_t>(bins_.y) + static_cast<uint64_t>(y)) *
               static_cast<uint64_t>(bins_.x) +
           static_cast<uint64_t>(x);
  }
  uint64_t bin_mask() const { return (uint64_t{1} << bin_bits_) - 1; }
  void search(const Bin& bin, std::span<const Vec3d> places, std::span<const uint8_t> changed, Scratch& scratch,
              std::vector<Pair>& found) const;

  std::span<const Triangle> triangles_;
  const Parallel& parallel_;
  Vec3d origin_;
  double per_voxel_;
  int side_ = 0;  ///< of a bin, log2 of voxels
  Vec3i bins_;    ///< along each axis
  int bin_bits_ = 0;
  std::vector<uint64_t> entries_;  ///< triangle << bin_bits_ | bin, by bin and triangle
  std::vector<Bin> by_bin_;        ///< those with more than one triangle
};

}  // namespace soapfilm
