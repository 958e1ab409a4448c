#include "soapfilm/extract/crossings.h"

#include <algorithm>
#include <bit>

#include "soapfilm/core/box.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/radix_sort.h"
#include "soapfilm/core/triangle_pair.h"

namespace soapfilm {

namespace {

constexpr int least_side = 1;      // of a bin, log2 of voxels
constexpr double steps = 0x1p23;   // of the integer lattice in a voxel: a lattice has less than 2^15 voxels a side
constexpr double slack = 2e-6;     // voxels, about boxes: far more than a step, and than what float rounds in a bin
constexpr double certain = 1e-12;  // voxels^3: what rounding does to a product of three lengths stays far below
constexpr size_t triangles_per_task = 1 << 14;
constexpr size_t vertices_per_task = 1 << 14;
constexpr size_t bins_per_task = 256;

/// A triangle, its corners on the integer lattice but in voxels: their differences are exact.
struct Item {
  uint32_t triangle;
  Triangle vertices;
  std::array<Vec3d, 3> corner;
  Vec3d normal;  // not of unit length

  LatticeTriangle on_lattice() const {
    LatticeTriangle t;
    for (size_t k = 0; k < 3; ++k) t[k] = static_cast<LatticePoint>(corner[k] * steps);
    return t;
  }
};

/// A plane through `a`, or upright on it through one of its edges, has `b` strictly on the far side, but for the corner
/// that they share: the first one of both when `shared` is 1.
template <int shared>
bool parted(const std::array<Vec3d, 3>& a, Vec3d normal, const std::array<Vec3d, 3>& b) {
  const auto all = [&](auto&& test) {
    bool yes = test(b[1]) & test(b[2]);
    if constexpr (shared == 0) yes &= test(b[0]);
    return yes;
  };
  if (all([&](const Vec3d& p) { return dot(normal, p - a[0]) > certain; })) return true;
  if (all([&](const Vec3d& p) { return dot(normal, p - a[0]) < -certain; })) return true;
  for (size_t k = 0; k < 3; ++k) {
    if (shared == 1 && k == 1) continue;
    const Vec3d outward = cross(a[k == 2 ? 0 : k + 1] - a[k], normal);
    if (all([&](const Vec3d& p) { return dot(outward, p - a[k]) > certain; })) return true;
  }
  return false;
}

std::array<Vec3d, 3> turned(const std::array<Vec3d, 3>& corner, size_t first) {
  return {corner[first], corner[(first + 1) % 3], corner[(first + 2) % 3]};
}

/// Exact; most pairs are told apart in floating point, with room for its rounding.
bool cross_each_other(const Item& a, const Item& b) {
  int shared = 0;
  size_t in_a = 0, in_b = 0;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      if (a.vertices[i] == b.vertices[j]) {
        ++shared;
        in_a = i;
        in_b = j;
      }
  if (shared == 0) {
    if (parted<0>(a.corner, a.normal, b.corner) || parted<0>(b.corner, b.normal, a.corner)) return false;
  } else if (shared == 1) {
    const auto s = turned(a.corner, in_a), t = turned(b.corner, in_b);
    if (parted<1>(s, a.normal, t) || parted<1>(t, b.normal, s)) return false;
  } else if (dot(a.normal, b.normal) > 0) {  // on one edge they meet elsewhere only when folded onto each other
    return false;
  }
  const LatticeTriangle s = a.on_lattice(), t = b.on_lattice();
  return !is_flat(s) && !is_flat(t) && improperly_meet(s, t);
}

}  // namespace

/// The triangles of a bin, and their boxes from its lowest corner.
class CrossingSearch::Scratch {
 public:
  void clear() {
    items_.clear();
    flags_.clear();
    for (auto& axis : lo_) axis.clear();
    for (auto& axis : hi_) axis.clear();
  }

  void add(uint32_t triangle, bool changed, const Triangle& t, std::span<const Vec3d> places, Vec3d bin, double side) {
    const std::array<Vec3d, 3> corner{places[t[0]], places[t[1]], places[t[2]]};
    uint8_t flags = changed ? is_changed : 0;
    std::array<double, 3> lo, hi;
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min({corner[0][axis], corner[1][axis], corner[2][axis]}) - bin[axis];
      hi[axis] = std::max({corner[0][axis], corner[1][axis], corner[2][axis]}) - bin[axis];
      if (lo[axis] >= side || hi[axis] < 0) return;
      if (lo[axis] >= 0) flags = static_cast<uint8_t>(flags | 1 << axis);
    }
    for (int axis = 0; axis < 3; ++axis) {
      lo_[axis].push_back(static_cast<float>(lo[axis] - slack));
      hi_[axis].push_back(static_cast<float>(hi[axis] + slack));
    }
    flags_.push_back(flags);
    items_.push_back({triangle, t, corner, cross(corner[1] - corner[0], corner[2] - corner[0])});
  }

  void find(std::vector<Pair>& found) {
    close_.resize(items_.size());
    for (size_t i = 0; i + 1 < items_.size(); ++i) {
      look_around(i);
      for (size_t j = i + 1; j < items_.size(); ++j) {
        if (!close_[j]) continue;
        // Of the bins that both are in, the one that holds the lowest corner of what their boxes share.
        const int flags = flags_[i] | flags_[j];
        if (!(flags & is_changed) || (flags & starts_here) != starts_here) continue;
        if (cross_each_other(items_[i], items_[j])) found.push_back({items_[i].triangle, items_[j].triangle});
      }
    }
  }

 private:
  static constexpr uint8_t starts_here = 7;  // bit k: along axis k the box starts in this bin
  static constexpr uint8_t is_changed = 8;

  /// Which of the later boxes overlap box i.
  void look_around(size_t i) {
    const float lx = lo_[0][i], ly = lo_[1][i], lz = lo_[2][i], hx = hi_[0][i], hy = hi_[1][i], hz = hi_[2][i];
    const float *x = lo_[0].data(), *y = lo_[1].data(), *z = lo_[2].data();
    const float *u = hi_[0].data(), *v = hi_[1].data(), *w = hi_[2].data();
    int* out = close_.data();
    for (size_t j = i + 1; j < items_.size(); ++j)
      out[j] = (x[j] <= hx) & (u[j] >= lx) & (y[j] <= hy) & (v[j] >= ly) & (z[j] <= hz) & (w[j] >= lz);
  }

  std::vector<Item> items_;
  std::vector<uint8_t> flags_;
  std::array<std::vector<float>, 3> lo_, hi_;  // by axis
  std::vector<int> close_;
};

CrossingSearch::CrossingSearch(std::span<const Vec3d> start, std::span<const Vec3d> target,
                               std::span<const Triangle> triangles, std::span<const uint8_t> changing, double voxel,
                               const Parallel& parallel)
    : triangles_(triangles), parallel_(parallel), per_voxel_(1 / voxel) {
  place_bins(start, target);
  const auto for_bins = [&](size_t t, auto&& visit) {
    Box3d box;
    for (const uint32_t v : triangles[t]) {
      box.extend(start[v]);
      box.extend(target[v]);
    }
    const Vec3i lo(place(box.lo) - Vec3d{slack, slack, slack}), hi(place(box.hi) + Vec3d{slack, slack, slack});
    for (int z = lo.z >> side_; z <= hi.z >> side_; ++z)
      for (int y = lo.y >> side_; y <= hi.y >> side_; ++y)
        for (int x = lo.x >> side_; x <= hi.x >> side_; ++x) visit(number_of(x, y, z));
  };
  // By some bits of the bin's number: a triangle that changes may be in it.
  const size_t slots = std::bit_ceil(4 * triangles.size() + 1);
  std::vector<uint8_t> wanted(slots);
  for (size_t t = 0; t < triangles.size(); ++t)
    if (changing[t]) for_bins(t, [&](uint64_t bin) { wanted[bin & (slots - 1)] = 1; });
  entries_ = gather<uint64_t>(triangles.size(), triangles_per_task, parallel, [&](size_t t, auto& found) {
    for_bins(t, [&](uint64_t bin) {
      if (wanted[bin & (slots - 1)]) found.push_back(t << bin_bits_ | bin);
    });
  });
  radix_sort(entries_, bin_bits_);
  for (size_t i = 0, begin = 0; i < entries_.size(); ++i)
    if (i + 1 == entries_.size() || ((entries_[i] ^ entries_[i + 1]) & bin_mask()) != 0) {
      if (i > begin) by_bin_.push_back({begin, i + 1});
      begin = i + 1;
    }
}

/// As small as can be counted.
void CrossingSearch::place_bins(std::span<const Vec3d> start, std::span<const Vec3d> target) {
  Box3d box;
  for (const auto& vertices : {start, target})
    for (const Vec3d& v : vertices) box.extend(v);
  origin_ = box.lo;
  const Vec3i last(place(box.hi) + Vec3d{1, 1, 1});
  for (side_ = least_side;; ++side_) {
    bins_ = Vec3i{last.x >> side_, last.y >> side_, last.z >> side_} + Vec3i{1, 1, 1};
    bin_bits_ = static_cast<int>(std::bit_width(number_of(bins_.x - 1, bins_.y - 1, bins_.z - 1)));
    if (bin_bits_ + static_cast<int>(std::bit_width(triangles_.size())) <= 64) return;
  }
}

std::vector<CrossingSearch::Pair> CrossingSearch::find(std::span<const Vec3d> vertices,
                                                       std::span<const uint8_t> changed) const {
  std::vector<Vec3d> places(vertices.size());
  parallel_.for_each(places.size(), vertices_per_task, [&](size_t v) {
    places[v] = Vec3d(static_cast<LatticePoint>(place(vertices[v]) * steps)) / steps;
  });
  const size_t tasks = (by_bin_.size() + bins_per_task - 1) / bins_per_task;
  return gather<Pair>(tasks, 1, parallel_, [&](size_t task, std::vector<Pair>& found) {
    Scratch scratch;
    for (size_t b = task * bins_per_task; b < std::min((task + 1) * bins_per_task, by_bin_.size()); ++b)
      search(by_bin_[b], places, changed, scratch, found);
  });
}

void CrossingSearch::search(const Bin& bin, std::span<const Vec3d> places, std::span<const uint8_t> changed,
                            Scratch& scratch, std::vector<Pair>& found) const {
  const auto triangle = [&](size_t i) { return static_cast<uint32_t>(entries_[i] >> bin_bits_); };
  bool any = false;
  for (size_t i = bin.begin; i < bin.end; ++i) any |= changed[triangle(i)] != 0;
  if (!any) return;
  const auto number = static_cast<int64_t>(entries_[bin.begin] & bin_mask());
  const double side = 1 << side_;
  const Vec3d lowest =
      Vec3d(Vec3<int64_t>{number % bins_.x, number / bins_.x % bins_.y, number / bins_.x / bins_.y}) * side;
  scratch.clear();
  for (size_t i = bin.begin; i < bin.end; ++i)
    scratch.add(triangle(i), changed[triangle(i)] != 0, triangles_[triangle(i)], places, lowest, side);
  scratch.find(found);
}

}  // namespace soapfilm
