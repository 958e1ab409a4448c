// A grid's bricks shared by ranks: each has a slab, consecutive layers of bricks along z, of arrays that are as large
// as on one process. Bricks keep their numbers, a slab is one range of them, and memory that is never touched costs
// nothing.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/ordered_sum.h"

namespace soapfilm {

/// Layers of bricks, [begin, end) along z.
struct Layers {
  int begin = 0, end = 0;

  /// With those next to them.
  Layers widened(int below, int above) const { return {begin - below, end + above}; }
};

class Slabs {
 public:
  /// `cut`: z of the first layer of each slab, and of the layer after the last slab.
  Slabs(std::shared_ptr<Ranks> ranks, std::vector<int> cut) : ranks_(std::move(ranks)), cut_(std::move(cut)) {}
  /// About equal numbers of bricks for each rank; null where the context has no ranks, or the grid too few layers.
  static std::shared_ptr<const Slabs> of(const BrickGrid& grid, const Context& context);
  /// Those of a grid of half the resolution: each layer is with the first of the two that it covers or with the rank
  /// before, next to it.
  std::shared_ptr<const Slabs> halved() const;
  /// Whether slabs of this grid are thick enough to be worth their borders.
  bool suit(const BrickGrid& grid) const;

  Ranks& ranks() const { return *ranks_; }
  size_t count() const { return cut_.size() - 1; }
  Layers of_rank(size_t rank) const { return {cut_[rank], cut_[rank + 1]}; }
  Layers own() const { return of_rank(static_cast<size_t>(ranks_->rank())); }

  /// What layers(rank) gives, as parts of something, for each rank.
  template <class PartOf>
  std::vector<ItemRange> parts(PartOf&& part_of) const {
    std::vector<ItemRange> found;
    for (size_t r = 0; r < count(); ++r) found.push_back(part_of(of_rank(r)));
    return found;
  }

 private:
  std::shared_ptr<Ranks> ranks_;
  std::vector<int> cut_;
};

/// The bricks of some layers.
inline ItemRange bricks_of(const BrickGrid& grid, Layers layers) {
  const size_t begin = grid.bricks_below(layers.begin);
  return {begin, std::max(begin, grid.bricks_below(layers.end))};
}

/// Those of `count` items in lattice order, at z(k), that are in some layers.
template <class Z>
ItemRange items_of(size_t count, Layers layers, Z&& z) {
  const auto first_from = [&](int layer) {
    size_t begin = 0, end = count;
    while (begin < end) {
      const size_t middle = begin + (end - begin) / 2;
      if (z(middle) < layer)
        begin = middle + 1;
      else
        end = middle;
    }
    return begin;
  };
  const size_t begin = first_from(layers.begin);
  return {begin, std::max(begin, first_from(layers.end))};
}

/// Calls body(k) for the items of the own slab, `grain` of them per task, then brings each rank all of `values`.
/// Without slabs it calls body(k) for all.
template <class T, class Z, class Body>
void for_each_item(std::vector<T>& values, const Slabs* slabs, size_t grain, const Context& context, Z&& z,
                   Body&& body) {
  if (!slabs) return parallel_for(context, values.size(), grain, body);
  const ItemRange own = items_of(values.size(), slabs->own(), z);
  parallel_for(context, own.size(), grain, [&](size_t k) { body(own.begin + k); });
  bring_all(slabs->ranks(), slabs->parts([&](Layers layers) { return items_of(values.size(), layers, z); }),
            {{values.data(), sizeof(T)}});
}

/// The same with the bricks of a grid.
template <class T, class Body>
void for_each_brick(std::vector<T>& values, const BrickGrid& grid, const Slabs* slabs, size_t grain,
                    const Context& context, Body&& body) {
  for_each_item(
      values, slabs, grain, context, [&](size_t b) { return grid.coord(b).z; }, body);
}

/// ordered_sum() of term(k), k < count, of which each rank computes those of its slab.
template <class T, class Coord, class Term>
T ordered_sum(size_t count, const Slabs* slabs, const Context& context, Coord&& coord, Term&& term) {
  std::vector<T> terms(count);
  for_each_item(
      terms, slabs, 256, context, [&](size_t k) { return coord(k).z; }, [&](size_t k) { terms[k] = term(k); });
  return ordered_sum(terms, coord);
}

}  // namespace soapfilm
