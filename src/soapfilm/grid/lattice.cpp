#include "soapfilm/grid/lattice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

/// Keeps margins, and rounded-up boxes, of the deepest pyramid below 2^31. Memory is the limit long before.
constexpr int max_vertices_per_axis = 1 << 28;
constexpr int coarsest_vertices = 24;
constexpr int paper_levels = 3;
/// Every box is rounded up to whole bricks of the coarsest level: the largest length of such a brick, in lengths of the
/// shortest axis.
constexpr int longest_brick = 16;

int vertices_along(double length, double voxel, int padding) {
  // A length that is a whole number of voxels except for rounding must not get an additional cell.
  const double cells = std::max(1.0, std::ceil(length / voxel - 1e-6));
  const double vertices = cells + 2.0 * padding;
  if (vertices > max_vertices_per_axis)
    throw ParameterError(
        fmt::format("voxel = {:.6g}: the grid would have {:.10g} vertices along an axis, must be <= {}", voxel,
                    vertices, max_vertices_per_axis));
  return static_cast<int>(vertices);
}

/// Memory is prefetched along rows: short rows cost more than slightly larger layers.
int axis_shift_of(Vec3i along_world) {
  constexpr double much_larger = 1.25;
  const auto layer = [&](int shift) {
    const Vec3i size = permuted(along_world, shift);
    return static_cast<double>(size.x) * size.y;
  };
  const double least = std::min({layer(0), layer(1), layer(2)});
  int best = -1;
  for (int shift = 0; shift < 3; ++shift)
    if (layer(shift) <= much_larger * least &&
        (best < 0 || permuted(along_world, shift).x > permuted(along_world, best).x))
      best = shift;
  return best;
}

/// Moves the first vertex down by less than a voxel, onto one of the anchor's lattice, and the start of the lattice
/// onto the start of a tile.
void move_to(Vec3d anchor, Lattice& lattice) {
  constexpr double tile = brick_side << tile_bits, farthest = 0x1p50;
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = std::floor((lattice.first_vertex[axis] - anchor[axis]) / lattice.voxel);
    if (!(std::abs(steps) < farthest))
      throw ParameterError(
          fmt::format("anchor: {:g} voxels from the samples, must be less than 2^50", std::abs(steps)));
    lattice.first_vertex[axis] = anchor[axis] + steps * lattice.voxel;
    const double rest = std::fmod(steps - (1 << (lattice.levels - 1)), tile);
    lattice.below[axis] = static_cast<int>(rest < 0 ? rest + tile : rest);
  }
}

}  // namespace

LevelBox Lattice::box(int level) const {
  if (added > 0) {
    LevelBox box = of_level(added).box(std::max(0, level - added));
    box.level = level;
    if (const int finer = 1 << std::max(0, added - level); finer > 1) {
      box.free_lo = box.free_lo * finer;
      box.free_hi = (box.free_hi + Vec3i{1, 1, 1}) * finer - Vec3i{1, 1, 1};
      box.bricks = box.bricks * finer;
    }
    return box;
  }
  LevelBox box;
  box.level = level;
  box.open = open;
  for (int axis = 0; axis < 3; ++axis) {
    int first = margin()[axis] + (open ? 0 : 1), last = margin()[axis] + size[axis] - 2;
    if (open) {
      const int cell = 1 << std::min(same_border_levels, levels - 1);
      first &= ~(cell - 1);
      last |= cell - 1;
    }
    box.free_lo[axis] = first >> level;
    box.free_hi[axis] = last >> level;
  }
  // Enough bricks for the last free vertex of the finest level, rounded up so that every level's box covers the
  // children of the next coarser one: brick b has the children 2b and 2b + 1.
  const int cells = brick_side << (levels - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const int coarsest = (margin()[axis] + size[axis] - 2) / cells + 1;
    box.bricks[axis] = coarsest << (levels - 1 - level);
  }
  return box;
}

Lattice Lattice::of_level(int level) const {
  const int cell = 1 << level;
  Lattice coarse = *this;
  coarse.levels = levels - level;
  coarse.added = std::max(0, added - level);
  coarse.voxel = voxel * cell;
  for (int axis = 0; axis < 3; ++axis) coarse.below[axis] = below[axis] >> level;
  // Vertex I is the center of the fine vertices cell * I to cell * I + cell - 1.
  const double center = 0.5 * (cell - 1);
  coarse.first_vertex = to_world(Vec3d(coarse.margin() * cell) + Vec3d{center, center, center});
  for (int axis = 0; axis < 3; ++axis) {
    const int more = margin()[axis] - coarse.margin()[axis] * cell;
    coarse.size[axis] = (more + size[axis] + cell - 1) / cell;
  }
  return coarse;
}

Lattice Lattice::refined(int more) const {
  const int cell = 1 << more;
  Lattice fine = *this;
  fine.added = added + more;
  fine.levels = levels + more;
  fine.voxel = voxel / cell;
  fine.below = below * cell;
  fine.size = size * cell;
  // Its vertex margin() lies so far below the center of those that are this lattice's vertex margin().
  const double below_center = 0.5 * (cell - 1) / cell;
  fine.first_vertex = to_world(Vec3d(margin()) - Vec3d{below_center, below_center, below_center});
  return fine;
}

Lattice place_lattice(const Box3d& samples, double voxel, int padding, int levels, const std::optional<Vec3d>& anchor) {
  if (!(voxel > 0) || !std::isfinite(voxel)) throw ParameterError(fmt::format("voxel = {:g}, must be > 0", voxel));
  if (padding < 2) throw ParameterError(fmt::format("padding = {}, must be >= 2", padding));
  Lattice lattice;
  lattice.voxel = voxel;
  lattice.padding = padding;
  const Vec3d length = samples.size();
  Vec3i along_world;
  for (int axis = 0; axis < 3; ++axis)
    along_world[axis] = vertices_along(length[axis] + (anchor ? voxel : 0), voxel, padding);
  lattice.axis_shift = anchor ? 0 : axis_shift_of(along_world);
  lattice.size = lattice.from_world_axes(along_world);
  const double below = (padding - 0.5) * voxel;
  lattice.first_vertex = samples.lo - Vec3d{below, below, below};

  const auto [shortest, longest] = std::minmax({lattice.size.x, lattice.size.y, lattice.size.z});
  if (levels == 0) {
    levels = paper_levels;
    while ((longest >> (levels - 1)) > coarsest_vertices && brick_side << levels <= longest_brick * shortest) ++levels;
  }
  lattice.levels = levels;
  if (anchor) move_to(*anchor, lattice);
  return lattice;
}

double voxel_of_resolution(const Box3d& samples, int resolution, int padding) {
  const int least = 2 * padding + 1;
  if (resolution < least || resolution > max_vertices_per_axis)
    throw ParameterError(fmt::format("resolution = {}, must be between {} (2 padding + 1) and {}", resolution, least,
                                     max_vertices_per_axis));
  return samples.longest() / (resolution - 2 * padding);
}

}  // namespace soapfilm
