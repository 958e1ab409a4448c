#include "soapfilm/extract/crossings.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "soapfilm/core/box.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/radix_sort.h"
#include "soapfilm/core/triangle_pair.h"

namespace soapfilm {

namespace {

constexpr int least_side = 1;      // of a bin, log2 of voxels
constexpr double steps = 0x1p23;   // of the integer lattice in a voxel: lattice coordinates are below 2^15
constexpr double slack = 1e-6;     // voxels, about boxes: far more than a step
constexpr double certain = 1e-12;  // voxels^3: what rounding does to a product of three lengths stays far below
constexpr size_t triangles_per_task = 1 << 14;
constexpr size_t vertices_per_task = 1 << 14;
constexpr size_t bins_per_task = 256;
constexpr int none = -1;

Vec3i bin_of(Vec3d place, int side) {
  const auto part = [&](double x) { return static_cast<int>(std::floor(x)) >> side; };
  return {part(place.x), part(place.y), part(place.z)};
}

bool overlap(const Box3d& a, const Box3d& b) {
  return (a.lo.x <= b.hi.x) & (b.lo.x <= a.hi.x) & (a.lo.y <= b.hi.y) & (b.lo.y <= a.hi.y) & (a.lo.z <= b.hi.z) &
         (b.lo.z <= a.hi.z);
}

}  // namespace

/// A triangle, its corners on the integer lattice but in voxels: their differences are exact.
struct CrossingSearch::Item {
  uint32_t triangle;
  bool changed;
  Triangle vertices;
  std::array<Vec3d, 3> corner;
  Vec3d normal;  // not of unit length
  Box3d box;

  LatticeTriangle on_lattice() const {
    LatticeTriangle t;
    for (size_t k = 0; k < 3; ++k) t[k] = static_cast<LatticePoint>(corner[k] * steps);
    return t;
  }

  /// A plane through this triangle or upright through one of its edges has the other one strictly on the far side, but
  /// for the corner that they share, where there is one.
  bool parted_from(const Item& other, int own_shared, int its_shared) const {
    const Vec3d origin = corner[own_shared == none ? 0 : static_cast<size_t>(own_shared)];
    int above = 0, below = 0, count = 0;
    for (int j = 0; j < 3; ++j) {
      if (j == its_shared) continue;
      const double side = dot(normal, other.corner[static_cast<size_t>(j)] - origin);
      ++count;
      above += side > certain;
      below += side < -certain;
    }
    if (above == count || below == count) return true;
    for (int k = 0; k < 3; ++k) {
      const int next = k == 2 ? 0 : k + 1;
      if (own_shared != none && own_shared != k && own_shared != next) continue;
      const Vec3d from = corner[static_cast<size_t>(k)];
      const Vec3d outward = cross(corner[static_cast<size_t>(next)] - from, normal);
      bool beyond = true;
      for (int j = 0; j < 3; ++j)
        beyond &= j == its_shared || dot(outward, other.corner[static_cast<size_t>(j)] - from) > certain;
      if (beyond) return true;
    }
    return false;
  }
};

namespace {

/// Exact; most pairs are told apart without it.
template <class Item>
bool cross_each_other(const Item& a, const Item& b) {
  int shared = 0, in_a = none, in_b = none;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a.vertices[static_cast<size_t>(i)] == b.vertices[static_cast<size_t>(j)]) {
        ++shared;
        in_a = i;
        in_b = j;
      }
  // On one edge they meet beyond it only when they are folded onto each other.
  if (shared == 2 && dot(a.normal, b.normal) > 0) return false;
  if (shared < 2 && (a.parted_from(b, in_a, in_b) || b.parted_from(a, in_b, in_a))) return false;
  const LatticeTriangle s = a.on_lattice(), t = b.on_lattice();
  return !is_flat(s) && !is_flat(t) && improperly_meet(s, t);
}

}  // namespace

CrossingSearch::CrossingSearch(std::span<const Vec3d> start, std::span<const Vec3d> target,
                               std::span<const Triangle> triangles, const Lattice& lattice, const Parallel& parallel)
    : triangles_(triangles), lattice_(lattice), parallel_(parallel) {
  Box3d all;
  for (const auto& places : {start, target})
    for (const Vec3d& p : places) all.extend(p);
  const Vec3d margin{slack, slack, slack};
  for (side_ = least_side;; ++side_) {
    first_bin_ = bin_of(lattice.to_lattice(all.lo) - margin, side_);
    bins_ = bin_of(lattice.to_lattice(all.hi) + margin, side_) - first_bin_ + Vec3i{1, 1, 1};
    bin_bits_ = static_cast<int>(std::bit_width(number_of(bins_ - Vec3i{1, 1, 1})));
    if (bin_bits_ + static_cast<int>(std::bit_width(triangles.size())) <= 64) break;
  }
  entries_ =
      gather<uint64_t>(triangles.size(), triangles_per_task, parallel, [&](size_t t, std::vector<uint64_t>& found) {
        Box3d box;
        for (const uint32_t v : triangles[t]) {
          box.extend(start[v]);
          box.extend(target[v]);
        }
        const Vec3i lo = bin_of(lattice.to_lattice(box.lo) - margin, side_) - first_bin_;
        const Vec3i hi = bin_of(lattice.to_lattice(box.hi) + margin, side_) - first_bin_;
        for (int z = lo.z; z <= hi.z; ++z)
          for (int y = lo.y; y <= hi.y; ++y)
            for (int x = lo.x; x <= hi.x; ++x) found.push_back(t << bin_bits_ | number_of({x, y, z}));
      });
  radix_sort(entries_, bin_bits_);
  const uint64_t bin_mask = (uint64_t{1} << bin_bits_) - 1;
  for (size_t i = 0, begin = 0; i < entries_.size(); ++i)
    if (i + 1 == entries_.size() || ((entries_[i] ^ entries_[i + 1]) & bin_mask) != 0) {
      if (i > begin) by_bin_.push_back({begin, i + 1});
      begin = i + 1;
    }
}

std::vector<CrossingSearch::Pair> CrossingSearch::find(std::span<const Vec3d> vertices,
                                                       std::span<const uint8_t> changed) const {
  std::vector<Vec3d> places(vertices.size());
  parallel_.for_each(places.size(), vertices_per_task, [&](size_t v) {
    const Vec3d p = lattice_.to_lattice(vertices[v]) * steps;
    places[v] = Vec3d(static_cast<Vec3<int64_t>>(p)) / steps;
  });
  const size_t tasks = (by_bin_.size() + bins_per_task - 1) / bins_per_task;
  return gather<Pair>(tasks, 1, parallel_, [&](size_t task, std::vector<Pair>& found) {
    std::vector<Item> items;
    for (size_t b = task * bins_per_task; b < std::min((task + 1) * bins_per_task, by_bin_.size()); ++b)
      collect(by_bin_[b], places, changed, items, found);
  });
}

void CrossingSearch::collect(const Bin& bin, std::span<const Vec3d> places, std::span<const uint8_t> changed,
                             std::vector<Item>& items, std::vector<Pair>& found) const {
  const auto entry = [&](size_t i) { return triangle_of(entries_[i]); };
  bool any = false;
  for (size_t i = bin.begin; i < bin.end; ++i) any |= changed[entry(i)] != 0;
  if (!any) return;
  const uint64_t number = entries_[bin.begin] & ((uint64_t{1} << bin_bits_) - 1);
  items.clear();
  for (size_t i = bin.begin; i < bin.end; ++i) {
    const Triangle& t = triangles_[entry(i)];
    Item& item = items.emplace_back(
        Item{entry(i), changed[entry(i)] != 0, t, {places[t[0]], places[t[1]], places[t[2]]}, {}, {}});
    item.normal = cross(item.corner[1] - item.corner[0], item.corner[2] - item.corner[0]);
    for (const Vec3d& p : item.corner) item.box.extend(p);
  }
  for (size_t i = 0; i < items.size(); ++i)
    for (size_t j = i + 1; j < items.size(); ++j) {
      const Item &a = items[i], &b = items[j];
      if (!(a.changed | b.changed) || !overlap(a.box, b.box)) continue;
      // Of the bins that both are in, the one that holds the lowest corner of what their boxes share.
      const Vec3d corner{std::max(a.box.lo.x, b.box.lo.x), std::max(a.box.lo.y, b.box.lo.y),
                         std::max(a.box.lo.z, b.box.lo.z)};
      if (number_of(bin_of(corner, side_) - first_bin_) == number && cross_each_other(a, b))
        found.push_back({a.triangle, b.triangle});
    }
}

}  // namespace soapfilm
