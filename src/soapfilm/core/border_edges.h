// The edges at which a surface ends.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm {

/// Of these edges, given once by each triangle that has them with the smaller vertex first, those of one triangle
/// alone, sorted.
std::vector<std::pair<uint32_t, uint32_t>> edges_of_one_triangle(std::vector<std::pair<uint32_t, uint32_t>> edges);

/// Does each edge occur as often in one direction as in the other? Then the sum of random numbers of the edges, of
/// either sign, is zero, and only then but for a chance of 2^-64: no edges are kept or sorted.
bool is_closed(const Mesh& mesh);

}  // namespace soapfilm
