// A mesh as a tree of tiles: each shows a part of space, coarser than its children, and joins its neighbors of any
// level without a crack.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

struct TileParams {
  size_t triangles = 20000;  ///< of a tile, about; >= 100
};

/// Of an octree over the mesh's box. Coordinates are multiples of TileTree::step, small enough that differences of two
/// are floats.
struct Tile {
  int depth = 0;  ///< 0: the root
  Vec3i cell;     ///< in [0, 2^depth) along each axis
  Mesh mesh;
  double error = 0;  ///< input units: no point of this mesh is farther from the original, nor of the original's part
                     ///< from this mesh
  std::vector<size_t> children;  ///< numbers of tiles
};

struct TileTree {
  std::vector<Tile> tiles;  ///< the root last, children before their parents
  double step = 0;          ///< input units: rounding to it is a part of all errors

  const Tile& root() const { return tiles.back(); }
};

/// Cuts along edges, a triangle belongs to the cell of its middle. The leaves' triangles are the mesh's own; a parent's
/// are those of its children, simplified (soapfilm/simplify.h). Vertices that triangles of other tiles share stay in
/// place on all levels: so tiles of any levels fit.
/// The same bytes for any number of threads. Throws ParameterError for a mesh that is not a 2-manifold or has no
/// triangles, or a parameter out of range.
TileTree make_tiles(const Mesh& mesh, const TileParams& params, const Context& context);

}  // namespace soapfilm
