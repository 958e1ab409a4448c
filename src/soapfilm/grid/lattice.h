// Where the grid is in the world, and the boxes of its pyramid.
//
// Reported vertices are counted as in the paper: N along an axis, padding included, the outermost layer fixed to u = 0.
// Lattice coordinates, which all arrays use, add a margin of one coarsest cell on the low side:
//
//   lattice vertex = reported vertex + 2^(levels - 1),    coarse vertex I = lattice vertices 2I and 2I + 1 along an
//   axis
//
// (and up to a tile more, where the lattice is anchored in the world)
//
// so on every level vertex 0 is fixed and the faces of the fixed layer exist. Beyond the free vertices u = 0
// everywhere.
//
// The axes are those of the world, permuted so that layers along z are small: passes go through the lattice layer by
// layer, and the smaller these are, the more of one pass is still in the cache for the next.
#pragma once

#include <optional>

#include "soapfilm/core/vec.h"
#include "soapfilm/grid/layout.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Area of a surface, voxel^2, per face of the grid that separates its sides: the mean over its directions.
inline constexpr double area_per_face = 2.0 / 3;

/// The vertices of one level.
struct LevelBox {
  int level = 0;
  Vec3i free_lo;      ///< first vertex that is not fixed to u = 0
  Vec3i free_hi;      ///< last such vertex; inclusive
  Vec3i bricks;       ///< size of the box of bricks, from brick (0, 0, 0)
  bool open = false;  ///< instead of u = 0 beyond: faces between a free and a fixed vertex have no area and no flux

  bool is_free(Vec3i v) const {
    return v.x >= free_lo.x && v.y >= free_lo.y && v.z >= free_lo.z && v.x <= free_hi.x && v.y <= free_hi.y &&
           v.z <= free_hi.z;
  }
};

/// The coarsest level with the same open border as the finest one.
inline constexpr int same_border_levels = 3;

/// With a surface that may end at the border (`open`) the free vertices extend to the ends of whole cells of level 3,
/// so that the levels from there down have the same border; coarser ones have whole cells around it.
struct Lattice : GridFacts {
  Vec3i below;    ///< what the margin has in addition to 2^(levels - 1), along the lattice's axes
  int added = 0;  ///< levels that refined() has added below the placed one: its border is theirs

  /// Components of a vector along the lattice's axes, from those along the world's; and back.
  template <class T>
  Vec3<T> from_world_axes(Vec3<T> v) const {
    return permuted(v, axis_shift);
  }
  template <class T>
  Vec3<T> to_world_axes(Vec3<T> v) const {
    return permuted(v, 3 - axis_shift);
  }

  Vec3i margin() const { return below + Vec3i{1, 1, 1} * (1 << (levels - 1)); }
  double vertices() const { return static_cast<double>(size.x) * size.y * size.z; }

  /// Lattice coordinates of a world position, in voxels. In double: georeferenced input loses nothing.
  Vec3d to_lattice(Vec3d world) const { return from_world_axes(world - first_vertex) / voxel + Vec3d(margin()); }
  Vec3d to_world(Vec3d lattice) const { return first_vertex + to_world_axes(lattice - Vec3d(margin())) * voxel; }

  LevelBox box(int level) const;
  /// A lattice for one level, for example to draw it: its vertices have the same lattice coordinates as in box(level),
  /// and the same positions in the world.
  Lattice of_level(int level) const;
  /// With so many finer levels below this one, which becomes level `added` of it, with the same box: its vertices are
  /// the centers of 2^added finer ones along each axis.
  Lattice refined(int added) const;
};

/// Places a grid of the given voxel around the samples' box: N_k = ceil(L_k / voxel) + 2 padding, the first vertex
/// (padding - 1/2) voxels below the box. The axes are permuted so that layers along z are at most a quarter larger than
/// the smallest; of such permutations the one with the longest rows along x is used. `levels` 0: at least the paper's
/// three, more until the coarsest level has at most 24 vertices along its longest axis or another one would have less
/// than 2 along its shortest. Throws ParameterError if voxel <= 0, padding < 2, or an axis would have more than 2^28
/// vertices.
///
/// With an `anchor`, a world position: tiles (grid/layout.h) begin there and whole numbers of tiles from there,
/// and the axes are the world's. So the tiles of another lattice with the same anchor and voxel lie at the same places.
Lattice place_lattice(const Box3d& samples, double voxel, int padding, int levels = 0,
                      const std::optional<Vec3d>& anchor = {});

/// The voxel that gives `resolution` vertices along the longest axis: h = L_max / (resolution - 2 padding).
double voxel_of_resolution(const Box3d& samples, int resolution, int padding);

}  // namespace soapfilm
