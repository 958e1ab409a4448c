#include "soapfilm/orient/sample_cells.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/morton.h"
#include "soapfilm/core/radix_sort.h"

namespace soapfilm {

namespace {

constexpr size_t order_grain = size_t{1} << 14;
constexpr int parts_deeper = 2;  // a cell has 4 parts along each axis

size_t hash_of(uint64_t key) {
  key *= 0x9E3779B97F4A7C15ull;
  return static_cast<size_t>(key ^ key >> 32);
}

/// A cell's samples, dealt to at most two facets by the side that they were seen from.
struct Sides {
  std::array<Facet, 2> facet;
  std::array<Vec3d, 2> sum;
  std::array<uint64_t, 2> last_part{~uint64_t{0}, ~uint64_t{0}};
  Vec3f first;  ///< direction of the cell's first sample in the cloud

  /// Tells which facet it is.
  int add(Vec3d from_center, Vec3f direction, uint64_t part) {
    const int side = dot(first, direction) < 0 ? 1 : 0;
    const auto s = static_cast<size_t>(side);
    sum[s] += from_center;
    facet[s].direction += direction;
    ++facet[s].count;
    facet[s].distinct += part != last_part[s];
    last_part[s] = part;
    return side;
  }
};

}  // namespace

SampleOrder::SampleOrder(std::span<const Vec3d> positions, const Box3d& box, const Parallel& parallel)
    : low_(box.lo), longest_(box.longest()) {
  reserve_many(items_, positions.size());
  items_.resize(positions.size());
  parallel.for_each(positions.size(), order_grain, [&](size_t i) {
    items_[i] = {morton_key((positions[i] - low_) / longest_, deepest), static_cast<uint32_t>(i)};
  });
  radix_sort(items_, 3 * deepest, parallel, [](const Item& item) { return item.key; });
}

SampleCells::SampleCells(const SampleOrder& order, std::span<const Vec3d> positions, std::span<const Vec3f> directions,
                         int depth, const Parallel& parallel)
    : depth_(depth), side_(order.longest() / static_cast<double>(1 << depth)), second_(order.size()) {
  const int up = 3 * (SampleOrder::deepest - depth);
  const int up_parts = std::max(up - 3 * parts_deeper, 0);
  // A cell belongs to the chunk that its first sample is in.
  const auto begins = [&](size_t k) { return k == 0 || order.key(k) >> up != order.key(k - 1) >> up; };
  std::vector<size_t> first_cell((order.size() + order_grain - 1) / order_grain);
  parallel.for_chunks(order.size(), order_grain, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) first_cell[begin / order_grain] += begins(k);
  });
  size_t count = 0;
  for (size_t& first : first_cell) count += std::exchange(first, count);
  cells_.resize(count);
  facets_.resize(count);
  parallel.for_chunks(order.size(), order_grain, [&](size_t begin, size_t end) {
    size_t cell = first_cell[begin / order_grain];
    while (begin < end && !begins(begin)) ++begin;
    for (size_t k = begin; k < end; ++cell) {
      const size_t first = k;
      uint32_t earliest = order.sample(k);
      while (++k < order.size() && !begins(k)) earliest = std::min(earliest, order.sample(k));
      const uint64_t key = order.key(first) >> up;
      const Vec3i at{gather_coordinate(key), gather_coordinate(key >> 1), gather_coordinate(key >> 2)};
      const Vec3d center = order.low() + (Vec3d(at) + Vec3d{0.5, 0.5, 0.5}) * side_;
      Sides sides;
      sides.first = directions[earliest];
      for (size_t j = first; j < k; ++j) {
        const uint32_t i = order.sample(j);
        second_[j] = static_cast<uint8_t>(sides.add(positions[i] - center, directions[i], order.key(j) >> up_parts));
      }
      for (size_t s = 0; s < 2; ++s)
        if (sides.facet[s].count > 0) sides.facet[s].mean = Vec3f(sides.sum[s] / (side_ * sides.facet[s].count));
      cells_[cell] = {key, static_cast<uint32_t>(first)};
      facets_[cell] = sides.facet;
    }
  });
  table_.assign(std::bit_ceil(2 * cells_.size() + 1), none);
  for (size_t c = 0; c < cells_.size(); ++c) {
    size_t at = hash_of(cells_[c].key) & (table_.size() - 1);
    while (table_[at] != none) at = (at + 1) & (table_.size() - 1);
    table_[at] = static_cast<uint32_t>(c);
  }
  cells_.push_back({~uint64_t{0}, static_cast<uint32_t>(order.size())});
}

uint32_t SampleCells::find(uint64_t key) const {
  for (size_t at = hash_of(key);; ++at) {
    const uint32_t cell = table_[at & (table_.size() - 1)];
    if (cell == none || cells_[cell].key == key) return cell;
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
