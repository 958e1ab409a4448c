// Where triangles of about a voxel intersect.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// How a mesh changes: triangle t is `before[t]` at `start`, then `after[t]`, whose corners move towards `target` on
/// straight lines (input units).
struct MeshChange {
  std::span<const Triangle> before, after;
  std::span<const Vec3d> start, target;
  std::span<const uint8_t> changing;  ///< by triangle: only pairs with a marked triangle are searched
};

/// Finds pairs of triangles that come to meet elsewhere than in common corners and edges while a mesh without
/// self-intersections changes. The test is that of count_self_intersections(), exact, on coordinates rounded to 2^-23
/// voxel.
///
/// Space is divided into bins of two voxels. Two sheets that come to touch face each other in some bin: there the
/// triangles do not all face the same half of all directions during the whole motion. In the few bins for which this
/// holds every pair is tested. (Triangles that first touch in such a bin are not followed into other bins.)
class CrossingSearch {
 public:
  using Pair = std::array<uint32_t, 2>;  ///< triangles, the lower first

  /// Everything that `change` refers to must outlive the search. Fast when triangles are about a voxel long.
  CrossingSearch(const MeshChange& change, double voxel, const Context& context);

  /// With each vertex somewhere on its way, the pairs of which at least one triangle is marked by `changed`, some more
  /// than once, in an order that does not depend on the number of threads.
  std::vector<Pair> find(std::span<const Vec3d> vertices, std::span<const uint8_t> changed) const;

 private:
  struct Item;
  struct Bin {
    size_t begin, end;  ///< of entries_
  };

  struct Reach {
    Vec3<uint16_t> lo, hi;  ///< bins that a triangle is in at some time, both ends included
  };

  /// In voxels, all coordinates above 0.
  Vec3d place(Vec3d vertex) const { return (vertex - origin_) * per_voxel_ + Vec3d{1, 1, 1}; }
  void place_bins();
  Reach reach_of(size_t triangle) const;
  template <class Visit>
  void for_bins(const Reach& reach, Visit&& visit) const;
  std::vector<uint32_t> half_spaces(const std::vector<Reach>& reach, size_t first) const;
  uint32_t half_spaces_of(size_t triangle) const;
  uint64_t number_of(Vec3i bin) const;
  Vec3i bin_of(Vec3d place) const {
    const Vec3i cell(place);
    return {cell.x >> side_, cell.y >> side_, cell.z >> side_};
  }
  void search(const Bin& bin, std::span<const Vec3d> vertices, std::span<const uint8_t> changed,
              std::vector<Item>& items, std::vector<Pair>& found) const;

  MeshChange change_;
  const Context& context_;
  Vec3d origin_;
  double per_voxel_;
  int side_ = 0;  ///< of a bin, log2 of voxels
  Vec3i bins_;    ///< along each axis
  int bin_bits_ = 0;
  std::vector<uint64_t> entries_;  ///< triangle << bin_bits_ | bin, by bin and triangle
  std::vector<Bin> by_bin_;
};

}  // namespace soapfilm
