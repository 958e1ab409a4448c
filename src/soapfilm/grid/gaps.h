// What lies between the bricks of a grid: gaps, boxes of missing bricks. A gap is a run of missing bricks of a row, or
// the rows between two that hold bricks, or the slices between two such: there are about as many as bricks, however
// large the box is. A function that is constant on every connected set of missing bricks has one value per gap.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/grid/brick_range.h"

namespace soapfilm {

/// The gaps of a grid by BrickGrid::gap(), in lexicographic order. Where active bricks touch, the gap between them is
/// empty.
class Gaps {
 public:
  /// The grid must outlive them.
  explicit Gaps(const BrickGrid& grid);

  size_t size() const { return gaps_.size(); }
  const BrickRange& operator[](size_t gap) const { return gaps_[gap]; }

  /// visit(a, b) for every pair of gaps that touch, also by an edge or a corner, a < b.
  template <class Visit>
  void for_each_contact(Visit&& visit) const;

 private:
  /// Gaps [begin, end) of the same rows of a slice (or of slices without bricks): y from `lo` to `hi`.
  struct Strip {
    int lo, hi;
    size_t begin, end;
  };
  /// Strips [begin, end): z from `lo` to `hi`.
  struct Plate {
    int lo, hi;
    size_t begin, end;
  };
  template <class Visit>
  void join(const Strip& a, const Strip& b, Visit& visit) const;
  void add_strip(BrickRange range);

  std::vector<BrickRange> gaps_;
  std::vector<Strip> strips_;  // also without gaps that are not empty
  std::vector<Plate> plates_;
};

/// Vertices of a range; at most 2^48 are counted: what surrounds all may have more than an integer holds.
size_t count_vertices(const BrickRange& range);
/// Faces that two ranges of bricks share, in bricks.
double shared_faces(const BrickRange& a, const BrickRange& b);
/// Those of a range at the ends of the box that holds it.
double faces_at_end(const BrickRange& range, const BrickRange& box);

/// For each gap of a grid: whether u = 1 there. For a grid in some places of its box only (Domain::places), whose gaps
/// extend beyond these: for each brick.
class GapSides {
 public:
  GapSides() = default;
  /// All outside.
  explicit GapSides(const BrickGrid& grid) : inside_(grid.gaps(), 0) {}
  /// is_inside(brick) of one brick of each gap, one of `meant` where there are such; where there are none, outside.
  template <class IsInside>
  GapSides(const BrickGrid& grid, const BrickRange& meant, IsInside&& is_inside) : GapSides(grid) {
    const Gaps gaps(grid);
    for (size_t gap = 0; gap < gaps.size(); ++gap)
      if (const BrickRange common = gaps[gap].common(meant); !common.empty()) set(gap, is_inside(common.lo));
  }

  /// By brick: these are inside, all others outside.
  explicit GapSides(BrickMask inside) : by_brick_(std::make_shared<const BrickMask>(std::move(inside))) {}

  bool are_by_brick() const { return by_brick_ != nullptr; }
  /// By brick, these too are inside.
  GapSides with(BrickMask more) const {
    more |= *by_brick_;
    return GapSides(std::move(more));
  }
  /// Not where they are by brick.
  bool operator[](size_t gap) const { return inside_[gap] != 0; }
  void set(size_t gap, bool inside) { inside_[gap] = inside; }
  /// Of a brick that is not in their grid; false beyond its box.
  bool test(const BrickGrid& grid, int32_t slot, Vec3i brick) const {
    if (slot != outside_band) return false;
    return by_brick_ ? by_brick_->contains(brick) && by_brick_->test(brick) : inside_[grid.gap(brick)] != 0;
  }
  bool test(const BrickGrid& grid, Vec3i brick) const { return test(grid, grid.find(brick), brick); }
  /// The vertices that are inside, as count_vertices() counts.
  size_t count(const BrickGrid& grid) const;

 private:
  std::vector<uint8_t> inside_;
  std::shared_ptr<const BrickMask> by_brick_;  ///< null: by gap
};

template <class Visit>
void Gaps::join(const Strip& a, const Strip& b, Visit& visit) const {
  size_t first = b.begin;
  for (size_t g = a.begin; g < a.end; ++g) {
    if (gaps_[g].empty()) continue;
    while (first < b.end && gaps_[first].hi.x + 1 < gaps_[g].lo.x) ++first;
    for (size_t h = first; h < b.end && gaps_[h].lo.x <= gaps_[g].hi.x + 1; ++h)
      if (!gaps_[h].empty()) visit(g, h);
  }
}

template <class Visit>
void Gaps::for_each_contact(Visit&& visit) const {
  for (size_t p = 0; p < plates_.size(); ++p) {
    const Plate& plate = plates_[p];
    for (size_t s = plate.begin; s + 1 < plate.end; ++s) join(strips_[s], strips_[s + 1], visit);
    if (p + 1 == plates_.size()) break;
    size_t first = plates_[p + 1].begin;
    for (size_t s = plate.begin; s < plate.end; ++s) {
      while (first < plates_[p + 1].end && strips_[first].hi + 1 < strips_[s].lo) ++first;
      for (size_t t = first; t < plates_[p + 1].end && strips_[t].lo <= strips_[s].hi + 1; ++t)
        join(strips_[s], strips_[t], visit);
    }
  }
}

}  // namespace soapfilm
