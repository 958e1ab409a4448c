// Do two triangles of a mesh meet where they should not? Exact, on integer coordinates; internal.
#pragma once

#include <array>
#include <cstdint>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// A place on the integer lattice: |coordinate| <= 2^38, so that every determinant below fits 128 bits.
using LatticePoint = Vec3<int64_t>;
using LatticeTriangle = std::array<LatticePoint, 3>;

/// No area: the corners lie on a line.
bool is_flat(const LatticeTriangle& t);

/// A point of both that is no common corner or edge. Neither may be flat.
bool improperly_meet(const LatticeTriangle& a, const LatticeTriangle& b);

}  // namespace soapfilm
