#include "soapfilm/relax/crossings.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "soapfilm/core/half_spaces.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/radix_sort.h"
#include "soapfilm/core/share.h"
#include "soapfilm/core/triangle_pair.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

constexpr int least_side = 1;     // of a bin, log2 of voxels
constexpr double steps = 0x1p23;  // of the integer lattice per voxel: a lattice has less than 2^15 voxels a side
constexpr double slack = 1e-6;    // voxels, about boxes: far more than a step
constexpr size_t triangles_per_task = 1 << 14;
constexpr size_t bins_per_task = 64;

constexpr uint32_t unchanged = ~uint32_t{0};

}  // namespace

struct CrossingSearch::Item {
  uint32_t triangle;
  bool changed;
  LatticeTriangle corner;
  Box3d box;  // voxels
};

CrossingSearch::CrossingSearch(const MeshChange& change, double voxel, const Context& context)
    : change_(change), context_(context), per_voxel_(1 / voxel) {
  place_bins();
  {
    // Of the triangles that are this rank's part.
    const ItemRange own = own_part(even_parts(change.after.size(), context), context);
    std::vector<Reach> reach(own.size());
    parallel_for(context, own.size(), triangles_per_task, [&](size_t k) { reach[k] = reach_of(own.begin + k); });
    const std::vector<uint32_t> common = half_spaces(reach, own.begin);
    entries_ = lists_of_all(gather<uint64_t>(own.size(), triangles_per_task, context,
                                             [&](size_t k, auto& found) {
                                               for_bins(reach[k], [&](uint64_t bin) {
                                                 if (common[bin & (common.size() - 1)] == 0)
                                                   found.push_back(uint64_t{own.begin + k} << bin_bits_ | bin);
                                               });
                                             }),
                            context);
  }
  radix_sort(entries_, bin_bits_, context);
  const uint64_t bin_mask = (uint64_t{1} << bin_bits_) - 1;
  for (size_t i = 0, begin = 0; i < entries_.size(); ++i)
    if (i + 1 == entries_.size() || ((entries_[i] ^ entries_[i + 1]) & bin_mask) != 0) {
      by_bin_.push_back({begin, i + 1});
      begin = i + 1;
    }
}

/// Chooses the smallest bins for which a bin's and a triangle's number fit into 64 bits together.
void CrossingSearch::place_bins() {
  Box3d box;
  for (const auto& vertices : {change_.start, change_.target})
    for (const Vec3d& v : vertices) box.extend(v);
  origin_ = box.lo;
  for (side_ = least_side;; ++side_) {
    const Vec3i last = bin_of(place(box.hi) + Vec3d{slack, slack, slack});
    bins_ = last + Vec3i{1, 1, 1};
    bin_bits_ = static_cast<int>(std::bit_width(number_of(last)));
    if (bin_bits_ + static_cast<int>(std::bit_width(change_.after.size())) <= 64) return;
  }
}

uint64_t CrossingSearch::number_of(Vec3i bin) const {
  const auto row = static_cast<uint64_t>(bin.z) * static_cast<uint64_t>(bins_.y) + static_cast<uint64_t>(bin.y);
  return row * static_cast<uint64_t>(bins_.x) + static_cast<uint64_t>(bin.x);
}

CrossingSearch::Reach CrossingSearch::reach_of(size_t triangle) const {
  const Triangle &old = change_.before[triangle], &t = change_.after[triangle];
  Box3d box;
  for (const uint32_t v : t) box.extend(change_.start[v]);
  if (change_.start.data() != change_.target.data())
    for (const uint32_t v : t) box.extend(change_.target[v]);
  if (old != t)
    for (const uint32_t v : old) box.extend(change_.start[v]);
  const Vec3d margin{slack, slack, slack};
  return {Vec3<uint16_t>(bin_of(place(box.lo) - margin)), Vec3<uint16_t>(bin_of(place(box.hi) + margin))};
}

template <class Visit>
void CrossingSearch::for_bins(const Reach& reach, Visit&& visit) const {
  for (int z = reach.lo.z; z <= reach.hi.z; ++z)
    for (int y = reach.lo.y; y <= reach.hi.y; ++y)
      for (int x = reach.lo.x; x <= reach.hi.x; ++x) visit(number_of({x, y, z}));
}

/// By the low bits of the bins' numbers, the directions that all triangles of such bins face; all directions where none
/// changes. `reach` is that of the triangles from `first` on.
std::vector<uint32_t> CrossingSearch::half_spaces(const std::vector<Reach>& reach, size_t first) const {
  const size_t slots = std::bit_ceil(change_.after.size() / 4 + 1);
  std::vector<uint32_t> common(slots, unchanged);
  const auto for_slots = [&](size_t k, auto&& visit) {
    for_bins(reach[k], [&](uint64_t bin) { visit(std::atomic_ref<uint32_t>(common[bin & (slots - 1)])); });
  };
  constexpr auto order = std::memory_order_relaxed;
  const auto join_ranks = [&] { join_values(common, context_, [](uint32_t& all, uint32_t other) { all &= other; }); };
  parallel_for(context_, reach.size(), triangles_per_task, [&](size_t k) {
    if (change_.changing[first + k]) for_slots(k, [&](auto slot) { slot.store(all_half_spaces, order); });
  });
  join_ranks();
  parallel_for(context_, reach.size(), triangles_per_task, [&](size_t k) {
    uint32_t own = unchanged;  // not computed yet
    for_slots(k, [&](auto slot) {
      const uint32_t now = slot.load(order);
      if (now == unchanged || now == 0) return;
      if (own == unchanged) own = half_spaces_of(first + k);
      if ((now & own) != now) slot.fetch_and(own, order);
    });
  });
  join_ranks();
  return common;
}

/// The directions that the triangle faces during the whole motion: its normal is linear in the progress of each corner,
/// so its extremes are where each corner is at one of its ends. While a diagonal changes, the normal lies between those
/// of the old and the new triangle.
uint32_t CrossingSearch::half_spaces_of(size_t triangle) const {
  const Triangle &old = change_.before[triangle], &t = change_.after[triangle];
  const auto faced = [](const std::array<Vec3d, 3>& p) { return faced_half_spaces(cross(p[1] - p[0], p[2] - p[0])); };
  const auto at_start = [&](const Triangle& of) {
    return std::array<Vec3d, 3>{change_.start[of[0]], change_.start[of[1]], change_.start[of[2]]};
  };
  uint32_t all = faced(at_start(t));
  if (change_.start.data() != change_.target.data())
    for (unsigned arrived = 1; arrived < 8 && all != 0; ++arrived) {
      std::array<Vec3d, 3> corners = at_start(t);
      for (unsigned k = 0; k < 3; ++k)
        if (arrived >> k & 1) corners[k] = change_.target[t[k]];
      all &= faced(corners);
    }
  if (old != t) all &= faced(at_start(old));
  return all;
}

std::vector<CrossingSearch::Pair> CrossingSearch::find(std::span<const Vec3d> vertices,
                                                       std::span<const uint8_t> changed) const {
  const size_t tasks = (by_bin_.size() + bins_per_task - 1) / bins_per_task;
  return share_gather<Pair>(tasks, 1, context_, [&](size_t task, std::vector<Pair>& found) {
    std::vector<Item> items;
    for (size_t b = task * bins_per_task; b < std::min((task + 1) * bins_per_task, by_bin_.size()); ++b)
      search(by_bin_[b], vertices, changed, items, found);
  });
}

void CrossingSearch::search(const Bin& bin, std::span<const Vec3d> vertices, std::span<const uint8_t> changed,
                            std::vector<Item>& items, std::vector<Pair>& found) const {
  const auto triangle = [&](size_t i) { return static_cast<uint32_t>(entries_[i] >> bin_bits_); };
  bool any = false;
  for (size_t i = bin.begin; i < bin.end; ++i) any |= changed[triangle(i)] != 0;
  if (!any) return;
  items.clear();
  for (size_t i = bin.begin; i < bin.end; ++i) {
    Item item{triangle(i), changed[triangle(i)] != 0, {}, {}};
    for (size_t k = 0; k < 3; ++k) {
      item.corner[k] = static_cast<LatticePoint>(place(vertices[change_.after[item.triangle][k]]) * steps);
      item.box.extend(Vec3d(item.corner[k]) / steps);
    }
    if (!is_flat(item.corner)) items.push_back(item);
  }
  for (size_t i = 0; i < items.size(); ++i)
    for (size_t j = i + 1; j < items.size(); ++j) {
      const Item &a = items[i], &b = items[j];
      if (!a.changed && !b.changed) continue;
      const Vec3d lo{std::max(a.box.lo.x, b.box.lo.x), std::max(a.box.lo.y, b.box.lo.y),
                     std::max(a.box.lo.z, b.box.lo.z)};
      const Vec3d hi{std::min(a.box.hi.x, b.box.hi.x), std::min(a.box.hi.y, b.box.hi.y),
                     std::min(a.box.hi.z, b.box.hi.z)};
      if (lo.x > hi.x || lo.y > hi.y || lo.z > hi.z) continue;
      if (improperly_meet(a.corner, b.corner)) found.push_back({a.triangle, b.triangle});
    }
}

}  // namespace soapfilm
