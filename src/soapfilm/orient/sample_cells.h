// The samples in the cells of an octree: the parts of a surface in each cell of one depth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The samples of one side of the surface in a cell. (A cell that cuts a thin sheet holds samples of two.)
struct Facet {
  Vec3f mean;          ///< position relative to the cell's center, cells, each in [-1/2, 1/2]
  Vec3f direction;     ///< sum of the samples' directions
  uint32_t count = 0;  ///< samples
  uint64_t parts = 0;  ///< which of the cell's 64 parts (4 along each axis, by their Morton keys) contain one of them
};

/// Samples sorted along a Morton curve through the cube of their box's longest side, and the cells of any depth: a cell
/// of depth d has the side longest / 2^d. Depends neither on the number of threads nor
/// on the order of the cloud.
class SampleOrder {
 public:
  static constexpr int deepest = 18;

  /// Samples at one place are sorted by `directions`, which are as many as `positions`, or none.
  SampleOrder(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Box3d& box,
              const Context& context);

  size_t size() const { return items_.size(); }
  uint32_t sample(size_t k) const { return items_[k].sample; }
  uint64_t key(size_t k) const { return items_[k].key; }
  /// Random bits that follow from its place.
  uint32_t lot(size_t k) const { return items_[k].lot; }
  double longest() const { return longest_; }
  Vec3d low() const { return low_; }

 private:
  struct Item {
    uint64_t key;
    uint32_t sample;
    uint32_t lot;
  };
  void sort_equal_keys(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Context& context);

  std::vector<Item> items_;
  Vec3d low_;
  double longest_ = 0;
};

/// The occupied cells of one depth.
class SampleCells {
 public:
  /// `directions` is as long as `positions`; zero ones fit either side.
  SampleCells(const SampleOrder& order, std::span<const Vec3d> positions, std::span<const Vec3f> directions, int depth,
              const Context& context);

  /// The cells of the depth above, computed from these.
  SampleCells coarser(const SampleOrder& order, std::span<const Vec3f> directions, const Context& context) &&;

  struct Cell {
    uint64_t key;
    uint32_t begin;   ///< its first sample in the order; it ends where the next cell begins
    uint32_t chosen;  ///< one of its samples in the order, by lot
  };
  static constexpr uint32_t none = ~uint32_t{0};

  size_t size() const { return cells_.size() - 1; }
  const Cell& operator[](size_t cell) const { return cells_[cell]; }
  /// A cell's two sides; of the second, and in odd cases of the first, `count` may be 0.
  const std::array<Facet, 2>& facets(size_t cell) const { return facets_[cell]; }
  /// The side, 0 or 1, of the k-th sample of the order.
  size_t side_of(size_t k) const { return second_[k]; }
  double side() const { return side_; }

  /// The 27 cells around a cell by (dx + 1) + 3 (dy + 1) + 9 (dz + 1); `none` where no sample is.
  std::array<uint32_t, 27> around(size_t cell) const;

 private:
  SampleCells() = default;
  void index_cells(const Context& context);
  struct Block;
  uint32_t find_in(const Block& block, uint64_t key) const;

  int depth_ = 0;
  double side_ = 0;
  std::vector<Cell> cells_;  ///< by key; one more at the end
  std::vector<std::array<Facet, 2>> facets_;
  std::vector<uint8_t> second_;  ///< of each sample in the order: whether it belongs to its cell's second facet
  /// The cells of one cell some depths above are consecutive, and have a hash table of their own (open addressing): it
  /// is found where they are, in the cache or on disk.
  struct Block {
    uint64_t key;
    uint32_t first;  ///< cell
    uint32_t mask;   ///< of places in its table
    size_t begin;    ///< of its table
  };
  struct Slot {
    uint16_t tag;   ///< the key's low bits
    uint16_t cell;  ///< from the block's first one on
  };
  std::vector<Block> blocks_;  ///< by key
  std::vector<Slot> table_;
};

}  // namespace soapfilm
