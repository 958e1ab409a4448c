// The edges at which a surface ends.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace soapfilm {

/// Of these edges, given once by each triangle that has them with the smaller vertex first, those of one triangle
/// alone, sorted.
std::vector<std::pair<uint32_t, uint32_t>> edges_of_one_triangle(std::vector<std::pair<uint32_t, uint32_t>> edges);

}  // namespace soapfilm
