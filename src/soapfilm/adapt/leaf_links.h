// The leaves of several levels as vertices of one graph: each is linked to those around it.
//
// Between leaves of a level the links are those of a grid (solve/graph_cut.h), each weight times the area of the
// level's faces. Where levels meet, the finer leaves have their links, each to the coarser leaf that its end lies in;
// the coarser one adds none. With 6 neighbors and the anisotropic norm the cost of cutting links is the area of
// adapt/leaf_energy.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/solve/graph_cut.h"

namespace soapfilm {

/// A vertex of a leaf brick, whose number counts those of all levels.
struct Leaf {
  size_t brick = 0;
  int offset = 0;

  bool operator<(const Leaf& other) const { return brick != other.brick ? brick < other.brick : offset < other.offset; }
};

/// A set of leaves: bits for each leaf brick.
struct LeafSet {
  std::vector<BrickBits> bits;

  bool test(const Leaf& leaf) const {
    return bits[leaf.brick].layer[static_cast<size_t>(leaf.offset) / brick_area] >> leaf.offset % brick_area & 1;
  }
  void set(const Leaf& leaf) { bits[leaf.brick].set(leaf.offset); }
  size_t count() const;
  bool any() const;
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (size_t b = 0; b < bits.size(); ++b) bits[b].for_each([&](int i) { visit(Leaf{b, i}); });
  }
};

class LeafLinks {
 public:
  /// Only of closed boxes. `lambda`: of the placed level, lattice.added. `regions` must outlive them. Throws
  /// ParameterError as graph_links() does.
  LeafLinks(const Regions& regions, const Lattice& lattice, const GraphCutSetup& setup, double lambda,
            const Context& context);

  int levels() const { return static_cast<int>(levels_.size()); }
  const Regions& regions() const { return regions_; }
  const LevelBox& box(int level) const { return at(level).box; }
  double lambda(int level) const { return at(level).lambda; }
  const std::vector<Link>& links(int level) const { return at(level).links; }

  /// Leaf bricks with free vertices, the finest level's first.
  size_t bricks() const { return level_of_.size(); }
  int level(size_t brick) const { return level_of_[brick]; }
  Vec3i coord(size_t brick) const { return grid_of(brick).coord(brick - first_of(brick)); }
  /// The number of a leaf brick of a level; none: bricks().
  size_t find(int level, Vec3i brick) const;
  BrickBits free(size_t brick) const;
  LeafSet none() const { return {std::vector<BrickBits>(bricks())}; }
  uint64_t bytes() const;

  /// visit(other, weight) for all links of a free leaf; `other` is null where it is a fixed vertex.
  template <class Visit>
  void for_each_link(const Leaf& leaf, Visit&& visit) const;
  /// visit(number) for the leaf bricks around one; around a coarser one finer ones are not visited.
  template <class Visit>
  void for_each_beside(size_t brick, Visit&& visit) const;

 private:
  struct OfLevel {
    LevelBox box;
    double lambda = 0;
    std::vector<Link> links;
    BrickGrid grid;           ///< leaf bricks with free vertices
    std::vector<bool> whole;  ///< of each: whether all are free
    size_t first = 0;         ///< number of its first brick
  };
  enum class End : uint8_t { fixed, leaf, finer };

  const OfLevel& at(int level) const { return levels_[static_cast<size_t>(level)]; }
  const BrickGrid& grid_of(size_t brick) const { return at(level_of_[brick]).grid; }
  size_t first_of(size_t brick) const { return at(level_of_[brick]).first; }
  /// What is at a vertex of a level. `n`: its brick in the level's grid.
  End end_at(int level, Vec3i vertex, int32_t n, Leaf& found) const;
  template <class Visit>
  void for_each_finer(int level, Vec3i vertex, Visit&& visit) const;

  const Regions& regions_;
  std::vector<OfLevel> levels_;
  std::vector<uint8_t> level_of_;  ///< of each brick
};

template <class Visit>
void LeafLinks::for_each_link(const Leaf& leaf, Visit&& visit) const {
  const int level = level_of_[leaf.brick];
  const OfLevel& own = at(level);
  const size_t b = leaf.brick - own.first;
  const Vec3i brick = own.grid.coord(b), local = vertex_in_brick(leaf.offset), vertex = brick * brick_side + local;
  const bool whole = own.whole[b];
  bool touches_finer = false;
  for (const Link& link : own.links) {
    const Vec3i to = local + link.step, over = brick_of(to);
    if (whole && over == Vec3i{}) {
      const Leaf other{leaf.brick, brick_offset(to.x, to.y, to.z)};
      visit(&other, link.weight);
      continue;
    }
    const int32_t n = own.grid.neighbors(b)[static_cast<size_t>(neighbor_slot(over.x, over.y, over.z))];
    Leaf other;
    const End end = end_at(level, vertex + link.step, n, other);
    if (end == End::finer)
      touches_finer = true;
    else
      visit(end == End::leaf ? &other : nullptr, link.weight);
  }
  if (touches_finer) for_each_finer(level, vertex, visit);
}

/// The links of finer leaves that end in this one.
template <class Visit>
void LeafLinks::for_each_finer(int level, Vec3i vertex, Visit&& visit) const {
  for (int k = 0; k < 8; ++k)
    for (const Link& link : at(level - 1).links) {
      const Vec3i finer = child_of(vertex, k) + link.step;
      if (parent_of(finer) == vertex || !regions_.is_finer(level, brick_of(parent_of(finer)))) continue;
      Leaf other;
      const int32_t n = at(level - 1).grid.find(brick_of(finer));
      const End end = end_at(level - 1, finer, n, other);
      visit(end == End::leaf ? &other : nullptr, link.weight);
    }
}

template <class Visit>
void LeafLinks::for_each_beside(size_t brick, Visit&& visit) const {
  const int level = level_of_[brick];
  const OfLevel& own = at(level);
  const size_t b = brick - own.first;
  for (int slot = 0; slot < 27; ++slot) {
    const Vec3i step = slot_offset(slot);
    if (own.links.size() == 6 && dot(step, step) > 1) continue;
    if (const int32_t n = own.grid.neighbors(b)[static_cast<size_t>(slot)]; n >= 0) {
      visit(own.first + static_cast<size_t>(n));
    } else if (level + 1 < levels()) {
      const size_t coarser = find(level + 1, parent_of(own.grid.coord(b) + step));
      if (coarser < bricks()) visit(coarser);
    }
  }
}

}  // namespace soapfilm
