// Where the grid lies in the world, and the boxes of its pyramid.
//
// Reported vertices are counted as the paper does: N along an axis, padding included, the outermost layer fixed to
// u = 0. Lattice coordinates, which all arrays use, add a margin of one coarsest cell on the low side:
//
//   lattice vertex = reported vertex + 2^(levels - 1),    coarse vertex I = lattice vertices 2I and 2I + 1 along an
//   axis
//
// so on every level vertex 0 is fixed and the faces of the fixed layer exist. Beyond the free vertices u = 0
// everywhere.
//
// The axes are the world's, turned among themselves so that layers along z are small: passes go through the lattice
// layer by layer, and the smaller these are, the more of what one pass leaves is still in the cache for the next.
#pragma once

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
  Vec3i free_hi;      ///< last one; inclusive
  Vec3i bricks;       ///< size of the box of bricks, from brick (0, 0, 0)
  bool open = false;  ///< instead of u = 0 beyond: faces between a free and a fixed vertex have no area and no flux

  bool is_free(Vec3i v) const {
    return v.x >= free_lo.x && v.y >= free_lo.y && v.z >= free_lo.z && v.x <= free_hi.x && v.y <= free_hi.y &&
           v.z <= free_hi.z;
  }
};

/// The coarsest level whose open border is the finest one's.
inline constexpr int same_border_levels = 3;

/// A surface that may end at the border (`open`): free vertices then go on to the ends of whole cells of level 3, so
/// that the levels down from there have the same border; coarser ones have whole cells around it.
struct Lattice : GridFacts {
  /// A vector along the world's axes, along the lattice's; and back.
  template <class T>
  Vec3<T> from_world_axes(Vec3<T> v) const {
    return permuted(v, turn);
  }
  template <class T>
  Vec3<T> to_world_axes(Vec3<T> v) const {
    return permuted(v, 3 - turn);
  }

  int margin() const { return 1 << (levels - 1); }
  double vertices() const { return static_cast<double>(size.x) * size.y * size.z; }

  /// Lattice coordinates of a world position, in voxels. Computed in double: georeferenced input loses nothing.
  Vec3d to_lattice(Vec3d world) const {
    const double m = margin();
    return from_world_axes(world - first_vertex) / voxel + Vec3d{m, m, m};
  }
  Vec3d to_world(Vec3d lattice) const {
    const double m = margin();
    return first_vertex + to_world_axes(lattice - Vec3d{m, m, m}) * voxel;
  }

  LevelBox box(int level) const;
  /// A level of its own, such as to draw it: its vertices have there the lattice coordinates that they have in
  /// box(level), and lie in the world where they lie here.
  Lattice of_level(int level) const;
};

/// Places a grid of the given voxel around the samples' box: N_k = ceil(L_k / voxel) + 2 padding, the first vertex
/// (padding - 1/2) voxels below the box. The axes are turned so that layers along z are at most a quarter larger than
/// the smallest, and of such turns the one with the longest rows along x is taken. `levels` 0 chooses: at least the
/// paper's three, more until the coarsest level has at most 24 vertices along its longest axis or another one would
/// have less than 2 along its shortest. Throws ParameterError when voxel <= 0, padding < 2, or an axis would pass 2^28
/// vertices.
Lattice place_lattice(const Box3d& samples, double voxel, int padding, int levels = 0);

/// The voxel that gives `resolution` vertices along the longest axis: h = L_max / (resolution - 2 padding).
double voxel_of_resolution(const Box3d& samples, int resolution, int padding);

}  // namespace soapfilm
