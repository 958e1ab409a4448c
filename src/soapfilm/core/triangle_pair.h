// Whether two triangles of a mesh intersect improperly. Exact, on integer coordinates; internal.
#pragma once

#include <array>
#include <cstdint>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// A point of the integer lattice: |coordinate| <= 2^38, so that every determinant below fits 128 bits.
using LatticePoint = Vec3<int64_t>;
using LatticeTriangle = std::array<LatticePoint, 3>;

/// Whether it has no area: the corners lie on a line.
bool is_flat(const LatticeTriangle& t);

/// Whether they have a point in common other than a common corner or edge. Neither may be flat.
bool improperly_meet(const LatticeTriangle& a, const LatticeTriangle& b);

}  // namespace soapfilm
