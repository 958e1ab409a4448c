// Edges at which a surface turns from one side to another.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/remesh/sides.h"
#include "soapfilm/simplify/connectivity.h"

namespace soapfilm {

/// By half edge: borders, and edges where the sides of the two faces differ by more than 40 degrees. Regions between
/// such edges that are small against `edge` are given to what is around them: noise.
std::vector<uint8_t> sharp_edges(const Connectivity& mesh, const Sides& sides, double edge);

}  // namespace soapfilm
