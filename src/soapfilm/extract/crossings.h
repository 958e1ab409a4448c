// Where triangles of about a voxel pass through each other while their corners move.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/core/mesh.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

/// Pairs of triangles that meet elsewhere than in common corners and edges, among triangles that lie close to each
/// other. Judged as count_self_intersections() does, exactly, on coordinates rounded to 2^-23 voxel.
class CrossingSearch {
 public:
  using Pair = std::array<uint32_t, 2>;  ///< triangles, the lower first

  /// Every vertex will lie between `start` and `target` (input units), on the straight line. All must outlive it.
  CrossingSearch(std::span<const Vec3d> start, std::span<const Vec3d> target, std::span<const Triangle> triangles,
                 const Lattice& lattice, const Parallel& parallel);

  /// Those of which at least one triangle is marked by `changed`, each once, in an order that does not depend on the
  /// number of threads.
  std::vector<Pair> find(std::span<const Vec3d> vertices, std::span<const uint8_t> changed) const;

 private:
  struct Item;
  struct Bin {
    size_t begin, end;  ///< of entries_
  };

  void collect(const Bin& bin, std::span<const Vec3d> places, std::span<const uint8_t> changed,
               std::vector<Item>& items, std::vector<Pair>& found) const;
  uint32_t triangle_of(uint64_t entry) const { return static_cast<uint32_t>(entry >> bin_bits_); }
  /// From bins counted from the first.
  uint64_t number_of(Vec3i bin) const {
    return (static_cast<uint64_t>(bin.z) * static_cast<uint64_t>(bins_.y) + static_cast<uint64_t>(bin.y)) *
               static_cast<uint64_t>(bins_.x) +
           static_cast<uint64_t>(bin.x);
  }

  std::span<const Triangle> triangles_;
  const Lattice& lattice_;
  const Parallel& parallel_;
  int side_ = 0;            ///< of a bin, log2 of voxels
  Vec3i first_bin_, bins_;  ///< of the lattice's, those that the mesh lies in
  int bin_bits_ = 0;
  std::vector<uint64_t> entries_;  ///< triangle << bin_bits_ | bin, by bin and triangle
  std::vector<Bin> by_bin_;        ///< those with more than one triangle
};

}  // namespace soapfilm
