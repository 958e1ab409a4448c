// Where a mesh intersects itself.
#pragma once

#include <cstddef>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Pairs of triangles that have a point in common which is not a common vertex or edge of theirs: they cross, touch or
/// overlap. Vertices at the same place count as one; triangles without area are left out.
///
/// Coordinates are rounded to 2^-38 of the longest side of the mesh's box; for the rounded ones the answer is exact
/// (integers of 128 bits), so neither coplanar neighbors nor slivers are misjudged. Embree's tree proposes the pairs.
/// The result does not depend on the number of threads.
///
/// Throws ParameterError when a triangle names a vertex that does not exist or a coordinate is not finite.
size_t count_self_intersections(const Mesh& mesh, const Context& context);

}  // namespace soapfilm
