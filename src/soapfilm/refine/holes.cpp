#include "soapfilm/refine/holes.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "soapfilm/refine/robust_fit.h"
#include "soapfilm/refine/topology.h"
#include "soapfilm/solve/inside_bits.h"

namespace soapfilm {

namespace {

constexpr float sampled_within = 1;    // of every second vertex: two voxels
constexpr size_t least_film = 24;      // of every second vertex: a hole some 14 voxels wide
constexpr float film_depth = 1;        // voxels on either side; farther away samples of the surface do not hold it
constexpr double most_refused = 0.03;  // of the flips
constexpr int border_within = 2;       // voxels: nearer, the film ends at the border
constexpr int most_rounds = 12;
constexpr double reach = 2;    // of the band on every second vertex
constexpr float held = 0.05f;  // voxels, of vertices whose sign must not follow
constexpr double least_of_holes = 0.02, most_of_holes = 1;
constexpr double noise_to_follow = 0.1;  // voxels; with less, the least smoothing
constexpr double slope_of_curvature = 0.002;

uint64_t key_of(Vec3i v) {
  const auto bits = [](int c) { return static_cast<uint64_t>(static_cast<uint32_t>(c + 1)) & 0x1fffff; };
  return bits(v.x) | bits(v.y) << 21 | bits(v.z) << 42;
}

float value_at(const NarrowBand& band, const RowArray& values, Vec3i v, float otherwise) {
  const uint32_t row = band.row(band.grid().find(brick_of(v)), v.y & 7, v.z & 7);
  return band.mask(row) >> (v.x & 7) & 1 ? values.data()[size_t{row} * brick_side + static_cast<size_t>(v.x & 7)]
                                         : otherwise;
}

bool is_inside(const Level& level, float threshold, Vec3i v) {
  const int32_t b = level.grid.find(brick_of(v));
  const float u = b >= 0 ? level.u.brick(static_cast<size_t>(b))[brick_offset(v.x & 7, v.y & 7, v.z & 7)]
                         : level.missing_u(b, brick_of(v));
  return u > threshold;
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

/// Bricks and those next to them.
BrickMask with_neighbors(const BrickMask& bricks) {
  BrickMask more(bricks.bricks());
  bricks.for_each([&](Vec3i b) {
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i next = b + slot_offset(slot); more.contains(next)) more.set(next);
  });
  return more;
}

void set_with_neighbors(BrickMask& bricks, Vec3i vertex) {
  for (int slot = 0; slot < 27; ++slot)
    if (const Vec3i b = brick_of(vertex) + slot_offset(slot); bricks.contains(b)) bricks.set(b);
}

template <class Visit>
void for_each_vertex(const NarrowBand& band, Visit&& visit) {
  for (size_t b = 0; b < band.grid().size(); ++b)
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r)
      for (int x = 0; x < brick_side; ++x)
        if (band.mask(r) >> x & 1)
          visit(band.grid().first_vertex(b) + Vec3i{x, band.place(r) & 7, band.place(r) >> 3},
                size_t{r} * brick_side + static_cast<size_t>(x));
}

/// The surface on every second vertex near the holes, while it bends.
class CoarseFilm {
 public:
  CoarseFilm(const Level& fine, float threshold, const HoleFinder& finder, const GridSamples& samples,
             const Strength& strength, const Parallel& parallel)
      : fine_(fine), threshold_(threshold), finder_(finder), samples_(samples), parallel_(parallel) {
    // In units of every second vertex, where the surface has a quarter of the vertices.
    strength_.noise = strength.noise / 2;
    strength_.smoothing = strength.noise > noise_to_follow
                              ? std::clamp(strength.smoothing / 4, least_of_holes, most_of_holes)
                              : least_of_holes;
    robust_.slope_of_curvature = slope_of_curvature;
    robust_.solve = {60, 0.01};
  }

  void bend(const std::vector<Vec3i>& film, HoleReport& report);

  const BrickMask& bricks() const { return bricks_; }
  /// About the distance in units of every second vertex; beyond the band its sign alone.
  float distance(Vec3i v) const {
    const float far = static_cast<float>(reach) + 1;
    return value_at(start_.band, phi_, v, is_inside(level_, 0.5f, v) ? far : -far);
  }

 private:
  void make_level();
  size_t step(HoleReport& report);

  const Level& fine_;
  float threshold_;
  const HoleFinder& finder_;
  const GridSamples& samples_;
  const Parallel& parallel_;
  Strength strength_;
  RobustParams robust_;
  BrickMask bricks_;  // of the band: those that hold films, and those next to them
  Level level_;       // the indicator, on one more brick around
  Start start_;
  RowArray phi_;
};

/// The indicator on the bricks that are wanted now; what bent already stays.
void CoarseFilm::make_level() {
  const BrickMask wanted = with_neighbors(bricks_);
  Level next = every_second_vertex(fine_, threshold_, parallel_, &wanted);
  for (size_t b = 0; b < level_.grid.size(); ++b)
    if (const int32_t n = next.grid.find(level_.grid.coord(b)); n >= 0)
      std::copy_n(level_.u.brick(b), brick_volume, next.u.brick(static_cast<size_t>(n)));
  level_ = std::move(next);
}

/// Fits, and lets signs follow. Returns how many did.
size_t CoarseFilm::step(HoleReport& report) {
  make_level();
  start_ = start_from(level_, 0.5f, reach, parallel_, &bricks_);
  SignBits signs = signs_of(level_, 0.5f, start_, parallel_);
  {
    const GridSamples samples = on_every_second_vertex(samples_, parallel_, &bricks_);
    Displacement displacement(start_.band, start_.phi0, parallel_);
    CellSamples cells(samples, start_.band, parallel_);
    fit_robustly(displacement, start_.band, samples, cells, {}, strength_, robust_, parallel_);
    phi_ = std::move(displacement.phi());
  }
  // Where samples hold the surface the solve has decided.
  for_each_vertex(start_.band, [&](Vec3i v, size_t k) {
    const bool inside = signs.test(v);
    float& value = phi_.data()[k];
    if ((value > 0) != inside && finder_.is_sampled(v)) value = inside ? held : -held;
  });
  const FlipCount flips = follow(phi_, start_.band, signs, held, 0);
  report.refused = flips.refused;
  for (size_t b = 0; b < start_.grid.size(); ++b) {
    const int32_t n = level_.grid.find(start_.grid.coord(b));
    if (n < 0) continue;
    float* u = level_.u.brick(static_cast<size_t>(n));
    for (int k = 0; k < brick_volume; ++k) u[k] = signs.row(b, k >> 3 & 7, k >> 6) >> (k & 7) & 1 ? 1.0f : 0.0f;
  }
  for_each_vertex(start_.band, [&](Vec3i v, size_t k) {
    if (std::abs(phi_.data()[k]) < 1 && !finder_.is_sampled(v) && signs.test(v) != is_inside(fine_, threshold_, 2 * v))
      set_with_neighbors(bricks_, v);
  });
  return flips.wanted - flips.refused;
}

void CoarseFilm::bend(const std::vector<Vec3i>& film, HoleReport& report) {
  bricks_ = BrickMask(Vec3i{fine_.box.bricks.x + 1, fine_.box.bricks.y + 1, fine_.box.bricks.z + 1} / 2);
  for (const Vec3i v : film) set_with_neighbors(bricks_, v);
  report.rounds = 0;
  while (report.rounds < most_rounds) {
    ++report.rounds;
    if (step(report) == 0) break;
  }
}

/// Where a brick of the grid differs from the bent film: one byte per row, bit x for vertex x.
std::array<uint8_t, brick_area> differences(const Level& fine, float threshold, Vec3i brick, const CoarseFilm& film,
                                            const HoleFinder& finder) {
  // The vertices of every second one that the brick asks for.
  constexpr int side = half_brick + 1;
  std::array<float, static_cast<size_t>(side) * side * side> distance;
  std::array<bool, static_cast<size_t>(side) * side * side> bends;
  for (int k = 0; k < side * side * side; ++k) {
    const Vec3i v = half_brick * brick + Vec3i{k % side, k / side % side, k / side / side};
    bends[static_cast<size_t>(k)] = !finder.is_sampled(v);
    distance[static_cast<size_t>(k)] = bends[static_cast<size_t>(k)] ? film.distance(v) : 0;
  }
  const BrickBits inside = inside_of(fine, threshold, fine.grid.find(brick), brick);
  const FreeRange free = free_range(fine.box, brick);
  std::array<uint8_t, brick_area> found{};
  for (int z = free.lo.z; z < free.hi.z; ++z)
    for (int y = free.lo.y; y < free.hi.y; ++y)
      for (int x = free.lo.x; x < free.hi.x; ++x) {
        float sum = 0;
        bool all = true;
        for (int corner = 0; corner < 8; ++corner) {
          const auto up = [corner](int c, int axis) { return (c + (corner >> axis & 1)) / 2; };
          const auto k = static_cast<size_t>(up(x, 0) + side * (up(y, 1) + side * up(z, 2)));
          all = all && bends[k];
          sum += distance[k];
        }
        if (all && (sum > 0) != inside.test(x, y, z))
          found[static_cast<size_t>(y + brick_side * z)] |= static_cast<uint8_t>(1 << x);
      }
  return found;
}

/// The bricks of the grid that differ from the bent film.
BrickMask differing_bricks(const Level& fine, float threshold, const CoarseFilm& film, const HoleFinder& finder) {
  BrickMask found(fine.box.bricks);
  film.bricks().for_each([&](Vec3i parent) {
    for (int k = 0; k < 8; ++k) {
      const Vec3i brick = child_of(parent, k);
      if (!found.contains(brick)) continue;
      const auto rows = differences(fine, threshold, brick, film, finder);
      if (std::any_of(rows.begin(), rows.end(), [](uint8_t row) { return row != 0; })) found.set(brick);
    }
  });
  return found;
}

/// The level's indicator with signs that follow the film, on the start's bricks and those that differ.
Level bent_level(const Level& fine, float threshold, const Start& start, const CoarseFilm& film,
                 const HoleFinder& finder, const Parallel& parallel, HoleReport& report) {
  const BrickMask differing = differing_bricks(fine, threshold, film, finder);
  BrickMask wanted = differing;
  for (size_t b = 0; b < start.grid.size(); ++b) wanted.set(start.grid.coord(b));
  Level bent;
  bent.box = fine.box;
  bent.inside = start.inside;
  bent.grid = BrickGrid(wanted, parallel);
  std::vector<uint8_t> vertices(bent.grid.size() * brick_area);
  SignBits signs(bent.grid, bent.inside);
  parallel.for_each(bent.grid.size(), 64, [&](size_t b) {
    const Vec3i brick = bent.grid.coord(b);
    const BrickBits inside = inside_of(fine, threshold, fine.grid.find(brick), brick);
    for (int row = 0; row < brick_area; ++row) signs.row(b, row & 7, row >> 3) = inside.row(row & 7, row >> 3);
    if (!differing.test(brick)) return;
    const auto rows = differences(fine, threshold, brick, film, finder);
    std::copy(rows.begin(), rows.end(), vertices.begin() + static_cast<std::ptrdiff_t>(b * brick_area));
  });
  const NarrowBand band(bent.grid, vertices, parallel);
  RowArray phi = band.make_array();
  for_each_vertex(band, [&](Vec3i v, size_t k) { phi.data()[k] = signs.test(v) ? -1.0f : 1.0f; });
  const FlipCount flips = follow(phi, band, signs, held, 0);
  report.flips = flips.wanted - flips.refused;
  report.refused = flips.refused;
  bent.u = Field<float>(bent.grid);
  parallel.for_each(bent.grid.size(), 64, [&](size_t b) {
    float* u = bent.u.brick(b);
    for (int k = 0; k < brick_volume; ++k) u[k] = signs.test(b, k & 7, k >> 3 & 7, k >> 6) ? 1.0f : 0.0f;
  });
  return bent;
}

}  // namespace

HoleFinder::HoleFinder(const Level& level, const Start& start, const GridSamples& samples, const Parallel& parallel)
    : level_(level), start_(start), samples_(samples), near_(samples.bricks.size()) {
  const float none = 1e30f;
  std::vector<std::pair<Vec3f, Vec3f>> boxes(samples.bricks.size(), {{none, none, none}, {-none, -none, -none}});
  parallel.for_each(samples.bricks.size(), 16, [&](size_t b) {
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
      // Of the corners of its cell; others lie farther, or just as far.
      const Vec3i low{static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z)};
      for (int k = 0; k < 8; ++k) {
        const Vec3i w = low + octant_of(k);
        const Vec3f away = Vec3f(w) - c;
        if (dot(away, away) <= sampled_within * sampled_within)
          near_[b][static_cast<size_t>(w.y + side * w.z)] |= static_cast<uint8_t>(1 << w.x);
      }
    }
  });
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

bool HoleFinder::is_base(const std::vector<Vec3i>& film) const {
  constexpr float face_within = 2.5f;  // voxels
  constexpr double most = 0.8, steep_share = 0.6;
  constexpr float cosine = 0.5f;  // of 60 degrees
  constexpr int far = 4;          // of every second vertex, from the film to where the rim is looked at
  Vec3f normal{};
  for (const Vec3i v : film) normal = normal + gradient(2 * v);
  const float length = norm(normal);
  if (!(length > 0)) return false;
  normal = normal / length;
  bool at_face = false;
  for (int axis = 0; axis < 3; ++axis)
    for (const float face : {lo_[axis], hi_[axis]}) {
      size_t count = 0;
      for (const Vec3i v : film) count += std::abs(2 * static_cast<float>(v[axis]) - face) <= face_within + film_depth;
      at_face = at_face || (std::abs(normal[axis]) > 0.9f &&
                            static_cast<double>(count) >= most * static_cast<double>(film.size()));
    }
  if (!at_face) return false;
  std::unordered_map<uint64_t, bool> seen;
  size_t rim = 0, steep = 0;
  for (const Vec3i v : film)
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

std::vector<Vec3i> HoleFinder::film_to_bend(HoleReport& report) const {
  std::vector<Vec3i> unsampled;
  for_each_vertex(start_.band, [&](Vec3i v, size_t k) {
    if (((v.x | v.y | v.z) & 1) == 0 && std::abs(start_.phi0.data()[k]) <= film_depth && !is_sampled(v / 2))
      unsampled.push_back(v / 2);
  });
  const LevelBox& box = level_.box;
  const auto touches_border = [&](Vec3i v) {
    for (int axis = 0; axis < 3; ++axis)
      if (2 * v[axis] < box.free_lo[axis] + border_within || 2 * v[axis] > box.free_hi[axis] - border_within)
        return true;
    return false;
  };
  std::vector<Vec3i> bend;
  for (const std::vector<Vec3i>& film : parts_of(unsampled)) {
    if (film.size() < least_film) continue;
    if (box.open || std::any_of(film.begin(), film.end(), touches_border) || is_base(film)) {
      ++report.left;
      continue;
    }
    ++report.bent;
    bend.insert(bend.end(), film.begin(), film.end());
  }
  return bend;
}

void bend_holes(Level& level, float threshold, const std::vector<Vec3i>& film, const HoleFinder& finder,
                const Strength& strength, Start& start, const GridSamples& samples, double start_reach,
                const Parallel& parallel, HoleReport& report) {
  Level bent;
  {
    CoarseFilm coarse(level, threshold, finder, samples, strength, parallel);
    coarse.bend(film, report);
    bent = bent_level(level, threshold, start, coarse, finder, parallel, report);
  }
  // Where much wants to go through other parts of the surface, this is no hole that bends as what is around it.
  if (static_cast<double>(report.refused) > most_refused * static_cast<double>(report.flips)) {
    report.left += std::exchange(report.bent, 0);
    report.flips = 0;
  }
  if (report.flips == 0) return;
  level = std::move(bent);
  start = start_from(level, threshold, start_reach, parallel);
}

}  // namespace soapfilm
