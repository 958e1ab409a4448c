#include "soapfilm/orient/sample_cells.h"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include "soapfilm/core/checks.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/morton.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/radix_sort.h"
#include "soapfilm/core/some_by_place.h"

namespace soapfilm {

namespace {

constexpr size_t order_grain = size_t{1} << 14;
constexpr size_t cells_grain = size_t{1} << 12;
constexpr int parts_deeper = 2;  // a cell has 4 parts along each axis

/// A block is a cell so many depths above; `tag_bits` of a key tell its cells apart.
constexpr int block_depths = 5, tag_bits = 3 * block_depths;
constexpr uint16_t no_cell = 0xFFFF;

/// Neighbors share cache lines: the eight cells of a parent are consecutive.
constexpr uint32_t siblings = 8;
constexpr uint32_t next_place = siblings + 1;  // odd, so that it visits all places of a table
uint32_t hash_of(uint16_t tag) {
  const uint32_t parent = static_cast<uint32_t>(tag >> 3) * 0x9E3779B1u;
  return (parent ^ parent >> 15) * siblings | (tag & (siblings - 1));
}
uint16_t tag_of(uint64_t key) { return static_cast<uint16_t>(key & ((1u << tag_bits) - 1)); }

/// The samples of a cell, divided into at most two facets by the side from which they were seen.
struct Sides {
  std::array<Facet, 2> facet;
  std::array<Vec3d, 2> sum;  ///< of positions relative to the cell's center, cells
  Vec3f first;               ///< direction of one of the cell's samples, chosen by lot

  /// Adds `count` samples, `from_center` their mean. Returns which facet it is.
  uint8_t add(Vec3d from_center, Vec3f direction, uint32_t count, uint64_t parts) {
    const uint8_t side = dot(first, direction) < 0 ? 1 : 0;
    sum[side] += from_center * static_cast<double>(count);
    facet[side].direction += direction;
    facet[side].count += count;
    facet[side].parts |= parts;
    return side;
  }

  std::array<Facet, 2> take() {
    for (size_t s = 0; s < 2; ++s)
      if (facet[s].count > 0) facet[s].mean = Vec3f(sum[s] / static_cast<double>(facet[s].count));
    return facet;
  }
};

/// For each chunk of `grain` items, how many begin something in the chunks before it; at the end, the total.
template <class Begins>
std::vector<size_t> count_before(size_t size, size_t grain, const Context& context, Begins&& begins) {
  std::vector<size_t> before((size + grain - 1) / grain + 1);
  parallel_chunks(context, size, grain, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) before[begin / grain] += begins(k);
  });
  size_t count = 0;
  for (size_t& first : before) count += std::exchange(first, count);
  return before;
}

/// A child's eighths as bits of its parent's 64 parts.
uint64_t parts_in_parent(uint64_t parts, uint64_t octant) {
  uint64_t eighths = 0;
  for (int j = 0; j < 8; ++j) eighths |= static_cast<uint64_t>((parts >> 8 * j & 255) != 0) << j;
  return eighths << 8 * octant;
}

}  // namespace

SampleOrder::SampleOrder(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Box3d& box,
                         const Context& context)
    : low_(box.lo), longest_(box.longest()) {
  reserve_many(items_, positions.size());
  items_.resize(positions.size());
  parallel_for(context, positions.size(), order_grain, [&](size_t i) {
    items_[i] = {morton_key((positions[i] - low_) / longest_, deepest), static_cast<uint32_t>(i),
                 static_cast<uint32_t>(hash_of_place(positions[i], box))};
  });
  radix_sort(items_, 3 * deepest, context, [](const Item& item) { return item.key; });
  sort_equal_keys(positions, directions, context);
}

void SampleOrder::sort_equal_keys(std::span<const Vec3d> positions, std::span<const Vec3f> directions,
                                  const Context& context) {
  Checks check(context);
  const auto place = [&](const Item& item) {
    const Vec3d p = positions[item.sample];
    const Vec3f d = directions.empty() ? Vec3f{} : directions[item.sample];
    return std::make_tuple(p.x, p.y, p.z, d.x, d.y, d.z);
  };
  for (size_t k = 0; k < items_.size();) {
    check();
    size_t end = k + 1;
    while (end < items_.size() && items_[end].key == items_[k].key) ++end;
    if (end > k + 1)
      std::stable_sort(items_.begin() + static_cast<std::ptrdiff_t>(k),
                       items_.begin() + static_cast<std::ptrdiff_t>(end),
                       [&](const Item& a, const Item& b) { return place(a) < place(b); });
    k = end;
  }
}

SampleCells::SampleCells(const SampleOrder& order, std::span<const Vec3d> positions, std::span<const Vec3f> directions,
                         int depth, const Context& context)
    : depth_(depth), side_(order.longest() / static_cast<double>(1 << depth)), second_(order.size()) {
  const int up = 3 * (SampleOrder::deepest - depth);
  const int up_parts = up - 3 * parts_deeper;
  // A cell belongs to the chunk that its first sample is in.
  const auto begins = [&](size_t k) { return k == 0 || order.key(k) >> up != order.key(k - 1) >> up; };
  const std::vector<size_t> first_cell = count_before(order.size(), order_grain, context, begins);
  cells_.resize(first_cell.back() + 1);
  facets_.resize(first_cell.back());
  parallel_chunks(context, order.size(), order_grain, [&](size_t begin, size_t end) {
    size_t cell = first_cell[begin / order_grain];
    while (begin < end && !begins(begin)) ++begin;
    for (size_t k = begin; k < end; ++cell) {
      const size_t first = k;
      size_t chosen = k;
      while (++k < order.size() && !begins(k))
        if (order.lot(k) < order.lot(chosen)) chosen = k;
      const uint64_t key = order.key(first) >> up;
      const Vec3i at{gather_coordinate(key), gather_coordinate(key >> 1), gather_coordinate(key >> 2)};
      const Vec3d center = order.low() + (Vec3d(at) + Vec3d{0.5, 0.5, 0.5}) * side_;
      Sides sides;
      sides.first = directions[order.sample(chosen)];
      for (size_t j = first; j < k; ++j) {
        const uint32_t i = order.sample(j);
        const uint64_t part = order.key(j) >> up_parts & 63;
        second_[j] = sides.add((positions[i] - center) / side_, directions[i], 1, uint64_t{1} << part);
      }
      cells_[cell] = {key, static_cast<uint32_t>(first), static_cast<uint32_t>(chosen)};
      facets_[cell] = sides.take();
    }
  });
  cells_.back() = {~uint64_t{0}, static_cast<uint32_t>(order.size()), none};
  index_cells(context);
}

SampleCells SampleCells::coarser(const SampleOrder& order, std::span<const Vec3f> directions,
                                 const Context& context) && {
  SampleCells parents;
  parents.depth_ = depth_ - 1;
  parents.side_ = 2 * side_;
  parents.second_ = std::move(second_);
  const auto begins = [&](size_t c) { return c == 0 || cells_[c].key >> 3 != cells_[c - 1].key >> 3; };
  const std::vector<size_t> first_parent = count_before(size(), cells_grain, context, begins);
  parents.cells_.resize(first_parent.back() + 1);
  parents.facets_.resize(first_parent.back());
  parallel_chunks(context, size(), cells_grain, [&](size_t begin, size_t end) {
    size_t parent = first_parent[begin / cells_grain];
    while (begin < end && !begins(begin)) ++begin;
    for (size_t c = begin; c < end; ++parent) {
      const size_t first = c;
      uint32_t chosen = cells_[c].chosen;
      while (++c < size() && !begins(c))
        if (order.lot(cells_[c].chosen) < order.lot(chosen)) chosen = cells_[c].chosen;
      Sides sides;
      sides.first = directions[order.sample(chosen)];
      for (size_t child = first; child < c; ++child) {
        const uint64_t octant = cells_[child].key & 7;
        const Vec3d corner = Vec3d{octant & 1 ? 0.25 : -0.25, octant & 2 ? 0.25 : -0.25, octant & 4 ? 0.25 : -0.25};
        std::array<uint8_t, 2> side{};
        for (size_t s = 0; s < 2; ++s) {
          const Facet& facet = facets_[child][s];
          if (facet.count == 0) continue;
          side[s] = sides.add(corner + Vec3d(facet.mean) * 0.5, facet.direction, facet.count,
                              parts_in_parent(facet.parts, octant));
        }
        for (size_t k = cells_[child].begin; k < cells_[child + 1].begin; ++k)
          parents.second_[k] = side[parents.second_[k]];
      }
      parents.cells_[parent] = {cells_[first].key >> 3, cells_[first].begin, chosen};
      parents.facets_[parent] = sides.take();
    }
  });
  parents.cells_.back() = cells_.back();
  parents.index_cells(context);
  return parents;
}

void SampleCells::index_cells(const Context& context) {
  constexpr size_t blocks_per_task = 16;
  Checks check(context);
  size_t places = 0;
  for (size_t c = 0; c < size();) {
    check();
    const size_t first = c;
    while (c < size() && cells_[c].key >> tag_bits == cells_[first].key >> tag_bits) ++c;
    const size_t own = std::bit_ceil(2 * (c - first) + siblings);
    blocks_.push_back(
        {cells_[first].key >> tag_bits, static_cast<uint32_t>(first), static_cast<uint32_t>(own - 1), places});
    places += own;
  }
  table_.resize(places);
  parallel_for(context, blocks_.size(), blocks_per_task, [&](size_t b) {
    const Block& block = blocks_[b];
    Slot* const table = table_.data() + block.begin;
    std::fill_n(table, size_t{block.mask} + 1, Slot{0, no_cell});
    const size_t end = b + 1 < blocks_.size() ? blocks_[b + 1].first : size();
    for (size_t c = block.first; c < end; ++c) {
      const uint16_t tag = tag_of(cells_[c].key);
      uint32_t at = hash_of(tag) & block.mask;
      while (table[at].cell != no_cell) at = (at + next_place) & block.mask;
      table[at] = {tag, static_cast<uint16_t>(c - block.first)};
    }
  });
}

uint32_t SampleCells::find_in(const Block& block, uint64_t key) const {
  const uint16_t tag = tag_of(key);
  for (uint32_t at = hash_of(tag);; at += next_place) {
    const Slot slot = table_[block.begin + (at & block.mask)];
    if (slot.cell == no_cell) return none;
    if (slot.tag == tag) return block.first + slot.cell;
  }
}

std::array<uint32_t, 27> SampleCells::around(size_t cell) const {
  const uint64_t key = cells_[cell].key;
  const Vec3i at{gather_coordinate(key), gather_coordinate(key >> 1), gather_coordinate(key >> 2)};
  const int end = 1 << depth_;
  std::array<std::array<uint64_t, 3>, 3> bits{};  // of each axis and step
  for (int axis = 0; axis < 3; ++axis)
    for (int step = -1; step <= 1; ++step)
      bits[static_cast<size_t>(axis)][static_cast<size_t>(step + 1)] =
          spread_coordinate(static_cast<uint64_t>(at[axis] + step)) << axis;
  const auto block_of = [&](uint64_t k) {
    const auto block = std::lower_bound(blocks_.begin(), blocks_.end(), k >> tag_bits,
                                        [](const Block& b, uint64_t wanted) { return b.key < wanted; });
    return block != blocks_.end() && block->key == k >> tag_bits ? &*block : nullptr;
  };
  const Block& own = *block_of(key);
  const auto find = [&](uint64_t k) {
    const Block* const block = k >> tag_bits == own.key ? &own : block_of(k);
    return block ? find_in(*block, k) : none;
  };
  const auto outside = [&](int axis, int step) { return at[axis] + step < 0 || at[axis] + step >= end; };
  std::array<uint32_t, 27> found{};
  for (int slot = 0; slot < 27; ++slot) {
    const Vec3i d{slot % 3 - 1, slot / 3 % 3 - 1, slot / 9 - 1};
    const auto s = static_cast<size_t>(slot);
    if (slot == 13)
      found[s] = static_cast<uint32_t>(cell);
    else if (outside(0, d.x) || outside(1, d.y) || outside(2, d.z))
      found[s] = none;
    else
      found[s] = find(bits[0][static_cast<size_t>(d.x + 1)] | bits[1][static_cast<size_t>(d.y + 1)] |
                      bits[2][static_cast<size_t>(d.z + 1)]);
  }
  return found;
}

}  // namespace soapfilm
