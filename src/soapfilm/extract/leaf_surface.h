// The surface between inside and outside leaves of several sizes, as one triangle mesh.
#pragma once

#include <functional>
#include <span>

#include "soapfilm/context.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/grid/leaves.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Whether a vertex of a level is inside where there are no leaves.
using SideWithoutLeaves = std::function<bool(int level, Vec3i vertex)>;

/// Dual marching cubes (Schaefer and Warren 2004) on the leaves' centers. `values[l]` belongs to `levels[l]`: signed
/// distances in voxels of that level, inside where > 0, or all of one unit times 2^-l. A cell has the up to eight
/// leaves around a corner of a leaf for its corners, and the loops of marching cubes on the cube that they form; where
/// one leaf is several of its corners a loop loses the points between them. Among leaves of one size that is marching
/// cubes with the table of extract/marching_cubes_table.h.
///
/// The surface point between two leaves is found by linear interpolation, at least 1/1000 of the way from either, and
/// between leaves of two sizes at least 1/50. The mesh is closed and manifold wherever leaves surround the surface;
/// of an open lattice it has what is in front of the border of each level (drawn_range()). Vertices are in the world
/// frame of `lattice`, that of the finest level, computed in double; their order and that of the triangles follow
/// levels and bricks and do not depend on the number of threads.
///
/// Throws ParameterError where levels are not balanced (check_leaves()), where the surface passes between two places
/// without leaves, and when it has 2^32 vertices or more.
Mesh extract_leaf_surface(LeafLevels levels, std::span<const Field<float>* const> values,
                          const SideWithoutLeaves& inside, const Lattice& lattice, const Context& context);

}  // namespace soapfilm
