#include "soapfilm/refine/holes/holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/refine/holes/coarse_hole_surface.h"

namespace soapfilm {

namespace {

constexpr double most_refused = 0.06;  // by the topology, as a share of the vertices that change
/// Of the vertices that change, in the last round: measured, bulges end at .005 or go on at .3, down to what lies
/// below.
constexpr double most_moving = 0.1;
constexpr double most_bulge = 0.5;  // volume over area^1.5 of a hole; half a ball on a disc: 0.376

using BrickRows = std::array<uint8_t, brick_area>;  // of a brick: one byte per row, bit x for vertex x

/// Transfers the curved surface over holes from the half-resolution grid to the full grid.
class CurvedToGrid {
 public:
  CurvedToGrid(const Labels& fine, const CoarseHoleSurface& surface, const HoleFinder& finder, const Context& context)
      : fine_(fine), surface_(surface), finder_(finder), context_(context) {}

  /// Labels that follow the curved surface, on the bricks near the surface.
  Labels bent(const std::vector<HoleSurface>& holes, HoleReport& report) const;

 private:
  BrickRows differences(Vec3i brick) const;
  BrickMask differing_bricks() const;
  void flip(SignBits& signs, const NarrowBand& band, const std::vector<HoleSurface>& holes, HoleReport& report) const;

  const Labels& fine_;
  const CoarseHoleSurface& surface_;
  const HoleFinder& finder_;
  const Context& context_;
};

/// Where a brick of the grid differs from the curved surface.
BrickRows CurvedToGrid::differences(Vec3i brick) const {
  // The half-resolution vertices that the brick needs.
  constexpr int side = half_brick + 1;
  std::array<float, static_cast<size_t>(side) * side * side> distance;
  std::array<bool, static_cast<size_t>(side) * side * side> bends;
  for (int k = 0; k < side * side * side; ++k) {
    const Vec3i v = half_brick * brick + Vec3i{k % side, k / side % side, k / side / side};
    bends[static_cast<size_t>(k)] = !finder_.is_sampled(v);
    distance[static_cast<size_t>(k)] = bends[static_cast<size_t>(k)] ? surface_.distance(v) : 0;
  }
  const BrickBits& inside = fine_.of(brick);
  const FreeRange free = free_range(fine_.box, brick);
  BrickRows found{};
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

BrickMask CurvedToGrid::differing_bricks() const {
  BrickMask found(fine_.box.bricks);
  surface_.bricks().for_each([&](Vec3i parent) {
    for (int k = 0; k < 8; ++k) {
      const Vec3i brick = child_of(parent, k);
      if (!found.contains(brick)) continue;
      const BrickRows rows = differences(brick);
      if (std::any_of(rows.begin(), rows.end(), [](uint8_t row) { return row != 0; })) found.set(brick);
    }
  });
  return found;
}

/// What happened to the holes in a connected set of bricks that differ; such a set is undone as a whole.
struct Outcome {
  size_t turned = 0, refused = 0;  // vertices
  int64_t gained = 0;              // of those turned: inwards less outwards
  size_t moving = 0;               // of those that changed in the last round
  double most = 0;                 // changes that the areas of the holes there allow
  bool fails() const {
    return static_cast<double>(moving) > most_moving * static_cast<double>(turned) ||
           static_cast<double>(refused) > most_refused * static_cast<double>(turned) ||
           static_cast<double>(turned) > most;
  }
};

/// Changes the labels of the band's vertices where the topology allows, and undoes, hole by hole, what went wrong.
void CurvedToGrid::flip(SignBits& signs, const NarrowBand& band, const std::vector<HoleSurface>& holes,
                        HoleReport& report) const {
  const BrickGrid& grid = band.grid();
  const SignBits before = signs;
  RowArray phi = band.make_array();
  for_each_vertex(band, [&](Vec3i v, size_t k) { phi.data()[k] = before.test(v) ? -1.0f : 1.0f; });
  follow(phi, band, signs, held_distance, 0);

  const auto differs = [&](size_t b) { return band.first_row(b) < band.first_row(b + 1); };
  DisjointSets sets(grid.size());
  std::vector<Outcome> outcome(grid.size());  // of each set, at its root
  for (size_t b = 0; b < grid.size(); ++b)
    for (const int32_t n : grid.neighbors(b))
      if (n >= 0 && differs(b) && differs(static_cast<size_t>(n)))
        sets.join(static_cast<uint32_t>(b), static_cast<uint32_t>(n));
  const auto outcome_of = [&](size_t b) -> Outcome& { return outcome[sets.root(static_cast<uint32_t>(b))]; };
  for (size_t b = 0; b < grid.size(); ++b)
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r) {
      const int y = band.place(r) & 7, z = band.place(r) >> 3;
      const auto wanted = static_cast<size_t>(count_bits(band.mask(r)));
      const unsigned was = before.row(b, y, z), is = signs.row(b, y, z);
      const auto turned = static_cast<size_t>(count_bits(was ^ is));
      outcome_of(b).turned += turned;
      outcome_of(b).gained += count_bits(is & ~was) - count_bits(was & ~is);
      outcome_of(b).refused += wanted - turned;
    }
  surface_.for_each_moving([&](Vec3i parent, size_t vertices) {
    for (int k = 0; k < 8; ++k)
      if (const int32_t b = grid.find(child_of(parent, k)); b >= 0 && differs(static_cast<size_t>(b))) {
        outcome_of(static_cast<size_t>(b)).moving += 8 * vertices;  // of the full grid
        return;
      }
  });
  // A hole belongs to every set that it passes through.
  std::vector<std::vector<uint32_t>> sets_of(holes.size());
  for (size_t f = 0; f < holes.size(); ++f) {
    for (const Vec3i v : holes[f])
      if (const int32_t b = grid.find(brick_of(2 * v)); b >= 0 && differs(static_cast<size_t>(b)))
        sets_of[f].push_back(sets.root(static_cast<uint32_t>(b)));
    std::sort(sets_of[f].begin(), sets_of[f].end());
    sets_of[f].erase(std::unique(sets_of[f].begin(), sets_of[f].end()), sets_of[f].end());
    const double area = 4 * static_cast<double>(holes[f].size());  // voxel^2: each has vertices on both sides
    for (const uint32_t s : sets_of[f]) outcome[s].most += most_bulge * area * std::sqrt(area);
  }
  report.flips = report.refused = 0;
  report.gained = 0;
  for (size_t b = 0; b < grid.size(); ++b) {
    const Outcome& whole = outcome_of(b);
    report.flips += whole.fails() ? 0 : outcome[b].turned;
    report.gained += whole.fails() ? 0 : outcome[b].gained;
    report.refused += whole.fails() ? 0 : outcome[b].refused;
    if (differs(b) && whole.fails())
      for (int row = 0; row < brick_area; ++row) signs.row(b, row & 7, row >> 3) = before.row(b, row & 7, row >> 3);
  }
  for (const std::vector<uint32_t>& passed : sets_of) {
    const bool flat = std::any_of(passed.begin(), passed.end(), [&](uint32_t s) { return outcome[s].fails(); });
    ++(flat ? report.left : report.curved);
  }
}

Labels CurvedToGrid::bent(const std::vector<HoleSurface>& holes, HoleReport& report) const {
  const BrickMask differing = differing_bricks();
  BrickMask near_surface = differing;
  const Start& start = finder_.start();
  add_bricks(start.grid, near_surface);
  Labels bent;
  bent.box = fine_.box;
  bent.grid = BrickGrid(near_surface, context_);
  bent.inside = GapSides(bent.grid, bricks_with_free(fine_.box),
                         [&](Vec3i brick) { return start.inside.test(start.grid, brick); });
  std::vector<uint8_t> vertices(bent.grid.size() * brick_area);
  SignBits signs(bent.grid, bent.inside);
  parallel_for(context_, bent.grid.size(), 64, [&](size_t b) {
    const Vec3i brick = bent.grid.coord(b);
    signs.set(b, fine_.of(brick));
    if (!differing.test(brick)) return;
    const BrickRows rows = differences(brick);
    std::copy(rows.begin(), rows.end(), vertices.begin() + static_cast<std::ptrdiff_t>(b * brick_area));
  });
  flip(signs, NarrowBand(bent.grid, vertices, context_), holes, report);
  bent.bits.resize(bent.grid.size());
  for (size_t b = 0; b < bent.grid.size(); ++b) bent.bits[b] = signs.bits(b);
  return bent;
}

}  // namespace

void make_room(Labels& labels) {
  LevelBox& box = labels.box;
  const Vec3i room = box.free_lo - Vec3i{1, 1, 1};
  box.free_lo = {1, 1, 1};
  box.free_hi = box.free_hi + room;
  for (int axis = 0; axis < 3; ++axis)
    box.bricks[axis] = std::max(box.bricks[axis], brick_of(box.free_hi + Vec3i{1, 1, 1})[axis] + 1);
}

bool curve_holes(Labels& labels, const std::vector<HoleSurface>& holes, const HoleFinder& finder,
                 const FitWeights& fit_weights, const Context& context, HoleReport& report) {
  Labels bent;
  {
    CoarseHoleSurface surface(labels, finder, fit_weights, context);
    if (surface.bend(holes, report))
      bent = CurvedToGrid(labels, surface, finder, context).bent(holes, report);
    else
      report.left += holes.size();
  }
  if (report.flips > 0) labels = std::move(bent);
  return report.flips > 0;
}

}  // namespace soapfilm
