#include "soapfilm/refine/holes/hole_finder.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "soapfilm/core/share.h"

namespace soapfilm {

namespace {

constexpr float sampled_within = 1;  // in half-resolution cells: two voxels
constexpr size_t least_hole = 24;    // half-resolution vertices: a hole about 14 voxels wide
constexpr float hole_depth = 1;      // voxels on either side; farther away, samples of the surface do not constrain it
constexpr double most_of_surface = 0.2;  // a larger part is no hole, but closes a surface that ends
constexpr int border_within = 2;         // voxels: nearer, the hole ends at the border

uint64_t key_of(Vec3i v) {
  const auto bits = [](int c) { return static_cast<uint64_t>(static_cast<uint32_t>(c + 1)) & 0x1fffff; };
  return bits(v.x) | bits(v.y) << 21 | bits(v.z) << 42;
}

/// Parts of a set of vertices, 26-connected, in the order of their first ones.
std::vector<std::vector<Vec3i>> parts_of(const std::vector<Vec3i>& vertices) {
  std::unordered_map<uint64_t, bool> left;
  left.reserve(vertices.size());
  for (const Vec3i v : vertices) left[key_of(v)] = true;
  std::vector<std::vector<Vec3i>> parts;
  const auto take = [&](Vec3i v) {
    const auto found = left.find(key_of(v));
    return found != left.end() && std::exchange(found->second, false);
  };
  for (const Vec3i first : vertices) {
    if (!take(first)) continue;
    std::vector<Vec3i> part{first};
    for (size_t k = 0; k < part.size(); ++k)
      for (int slot = 0; slot < 27; ++slot)
        if (const Vec3i next = part[k] + slot_offset(slot); take(next)) part.push_back(next);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

HoleFinder::HoleFinder(const Start& start, const GridSamples& samples, const Context& context)
    : start_(start), samples_(samples), near_(samples.bricks.size()) {
  const float none = 1e30f;
  std::vector<std::pair<Vec3f, Vec3f>> boxes(samples.bricks.size(), {{none, none, none}, {-none, -none, -none}});
  share_values(near_, 16, context, [&](size_t b) {
    auto& [lo, hi] = boxes[b];
    const Vec3i first = samples.bricks.first_vertex(b);
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Vec3f p = samples.local[s];
      if (!is_near_surface(
              first + Vec3i{static_cast<int>(p.x + 0.5f), static_cast<int>(p.y + 0.5f), static_cast<int>(p.z + 0.5f)}))
        continue;
      const Vec3f place = p + Vec3f(first), c = p * 0.5f;
      for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], place[axis]);
        hi[axis] = std::max(hi[axis], place[axis]);
      }
      // Only the corners of the sample's cell; other vertices are farther, or just as far.
      const Vec3i low{static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z)};
      for (int k = 0; k < 8; ++k) {
        const Vec3i w = low + octant_of(k);
        const Vec3f away = Vec3f(w) - c;
        if (dot(away, away) <= sampled_within * sampled_within)
          near_[b][static_cast<size_t>(w.y + side * w.z)] |= static_cast<uint8_t>(1 << w.x);
      }
    }
  });
  bring_items(boxes.size(), {boxes.data(), sizeof boxes[0]}, context, [](size_t b) { return b; });
  lo_ = {none, none, none};
  hi_ = {-none, -none, -none};
  for (const auto& [lo, hi] : boxes)
    for (int axis = 0; axis < 3; ++axis) {
      lo_[axis] = std::min(lo_[axis], lo[axis]);
      hi_[axis] = std::max(hi_[axis], hi[axis]);
    }
}

bool HoleFinder::is_near_surface(Vec3i v) const {
  const NarrowBand& band = start_.band;
  return band.mask(band.row(band.grid().find(brick_of(v)), v.y & 7, v.z & 7)) >> (v.x & 7) & 1;
}

bool HoleFinder::is_sampled(Vec3i v) const {
  const auto bricks_of = [](int c) { return std::pair{(c & 3) == 0 ? (c >> 2) - 1 : c >> 2, c >> 2}; };
  const auto [x0, x1] = bricks_of(v.x);
  const auto [y0, y1] = bricks_of(v.y);
  const auto [z0, z1] = bricks_of(v.z);
  for (int z = z0; z <= z1; ++z)
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const int32_t b = samples_.bricks.find({x, y, z});
        if (b < 0) continue;
        const Vec3i w = v - half_brick * Vec3i{x, y, z};
        if (near_[static_cast<size_t>(b)][static_cast<size_t>(w.y + side * w.z)] >> w.x & 1) return true;
      }
  return false;
}

Vec3f HoleFinder::gradient(Vec3i v) const {
  Vec3f slope;
  const float here = value_at(start_.band, start_.phi0, v, 0);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i step{};
    step[axis] = 1;
    slope[axis] =
        value_at(start_.band, start_.phi0, v + step, here) - value_at(start_.band, start_.phi0, v - step, here);
  }
  return slope;
}

bool HoleFinder::is_base(const HoleSurface& hole) const {
  constexpr float face_within = 2.5f;  // voxels
  constexpr double most = 0.8, steep_share = 0.6;
  constexpr float cosine = 0.5f;  // of 60 degrees
  constexpr int far = 4;          // half-resolution cells, from the hole to where the surface around it is examined
  Vec3f normal{};
  for (const Vec3i v : hole) normal = normal + gradient(2 * v);
  const float length = norm(normal);
  if (!(length > 0)) return false;
  normal = normal / length;
  bool at_face = false;
  for (int axis = 0; axis < 3; ++axis)
    for (const float face : {lo_[axis], hi_[axis]}) {
      size_t count = 0;
      for (const Vec3i v : hole) count += std::abs(2 * static_cast<float>(v[axis]) - face) <= face_within + hole_depth;
      at_face = at_face || (std::abs(normal[axis]) > 0.9f &&
                            static_cast<double>(count) >= most * static_cast<double>(hole.size()));
    }
  if (!at_face) return false;
  std::unordered_map<uint64_t, bool> seen;
  size_t rim = 0, steep = 0;
  for (const Vec3i v : hole)
    for (int dz = -far; dz <= far; ++dz)
      for (int dy = -far; dy <= far; ++dy)
        for (int dx = -far; dx <= far; ++dx) {
          if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) != far) continue;
          const Vec3i w = v + Vec3i{dx, dy, dz};
          if (std::abs(value_at(start_.band, start_.phi0, 2 * w, 9)) > 1 || !is_sampled(w)) continue;
          if (!seen.try_emplace(key_of(w), true).second) continue;
          const Vec3f slope = gradient(2 * w);
          ++rim;
          steep += std::abs(dot(slope, normal)) <= cosine * norm(slope);
        }
  return rim > 0 && static_cast<double>(steep) >= steep_share * static_cast<double>(rim);
}

std::vector<HoleSurface> HoleFinder::holes_to_curve(const Context& context, HoleReport& report) const {
  constexpr size_t bricks_of_a_task = 64;
  std::vector<uint32_t> of_brick(start_.band.grid().size());  // vertices on the surface
  const auto unsampled =
      share_gather<Vec3i>(of_brick.size(), bricks_of_a_task, context, [&](size_t b, HoleSurface& found) {
        for_each_vertex_of(start_.band, b, [&](Vec3i v, size_t k) {
          if (((v.x | v.y | v.z) & 1) != 0 || std::abs(start_.phi0.data()[k]) > hole_depth) return;
          ++of_brick[b];
          if (!is_sampled(v / 2)) found.push_back(v / 2);
        });
      });
  bring_items(of_brick.size(), {of_brick.data(), sizeof(uint32_t)}, context, [](size_t b) { return b; });
  const size_t all = std::accumulate(of_brick.begin(), of_brick.end(), size_t{0});
  const LevelBox& box = start_.box;
  const auto touches_border = [&](Vec3i v) {
    for (int axis = 0; axis < 3; ++axis)
      if (2 * v[axis] < box.free_lo[axis] + border_within || 2 * v[axis] > box.free_hi[axis] - border_within)
        return true;
    return false;
  };
  std::vector<HoleSurface> bend;
  for (HoleSurface& hole : parts_of(unsampled)) {
    if (hole.size() < least_hole) continue;
    const bool stays = static_cast<double>(hole.size()) > most_of_surface * static_cast<double>(all) ||
                       std::any_of(hole.begin(), hole.end(), touches_border) || is_base(hole);
    if (stays)
      ++report.left;
    else
      bend.push_back(std::move(hole));
  }
  return bend;
}

}  // namespace soapfilm
