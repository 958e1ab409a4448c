#include "soapfilm/refine/holes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "soapfilm/refine/coarse_film.h"
#include "soapfilm/refine/topology.h"
#include "soapfilm/solve/inside_bits.h"

namespace soapfilm {

namespace {

constexpr double most_refused = 0.03;  // of the flips

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
  const FlipCount flips = follow(phi, band, signs, held_distance, 0);
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
