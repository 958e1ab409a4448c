// The surface between the inside and the outside vertices of a sparse grid, as a triangle mesh.
#pragma once

#include <functional>
#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Vertices lo to hi along each axis, both included.
struct VertexRange {
  Vec3i lo, hi;
};

/// What is drawn of the surface of an open box: that between its free vertices, but for a layer of cells at the border,
/// where the values beyond it count.
std::optional<VertexRange> drawn_range(const LevelBox& box);

/// The constant value of a brick that is not in the grid, by brick coordinates; these may lie outside the box of
/// bricks.
using MissingBrickValue = std::function<float(Vec3i brick)>;

/// Marching cubes with the table of extract/marching_cubes_table.h. A vertex is inside where its value exceeds
/// `isovalue`; the surface point on an edge follows from linear interpolation. Where the surface almost meets a vertex
/// it is moved away along its normal, until none of the vertex's edges is cut nearer to it than at 1/1000, so that no
/// triangle degenerates and small ones have the orientation of the surface. Triangles are counter-clockwise seen from
/// outside, where values are lower.
///
/// The mesh is closed, manifold and without unused vertices whenever two missing bricks that touch (also by an edge or
/// a corner) carry values on the same side of `isovalue`; its components and genus are those of the inside vertices
/// 6-connected and the outside 26-connected. Vertices are in the world frame of `lattice`, computed in double. Their
/// order and that of the triangles follow the bricks and do not depend on the number of threads.
///
/// Of a `range` only the cells whose corners are in it are drawn: the mesh has a boundary where the surface leaves it.
///
/// Throws ParameterError when `value` belongs to another grid, when touching missing bricks disagree, or when the
/// surface has 2^32 vertices or more.
Mesh extract_isosurface(const BrickGrid& grid, const Field<float>& value, const MissingBrickValue& missing_value,
                        float isovalue, const Lattice& lattice, const Context& context,
                        const std::optional<VertexRange>& range = {});

/// The same for partly known values: only the cells are drawn whose eight corners have a `weight` > 0, so the surface
/// ends where nothing was seen (Curless and Levoy 1996, section 4). Bricks that are not in the grid are unknown.
///
/// The mesh is a manifold with boundary and without unused vertices: where two drawn cells around an edge share no
/// face, each gets a vertex of its own at the same place. Positions, order, orientation and errors as above.
Mesh extract_open_isosurface(const BrickGrid& grid, const Field<float>& value, const Field<float>& weight,
                             float isovalue, const Lattice& lattice, const Context& context);

}  // namespace soapfilm
