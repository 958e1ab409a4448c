// Indices have 32 bits: triangles and orders of samples take half the memory. What one run in memory may hold follows.
#pragma once

#include <cstdint>

namespace soapfilm {

inline constexpr uint64_t most_indices = UINT32_MAX;          ///< samples, vertices of a mesh, rows of a band
inline constexpr uint64_t most_triangles = most_indices / 3;  ///< of a mesh: their half edges have indices, too
inline constexpr uint64_t most_bricks = INT32_MAX;            ///< of a grid: negative is none

/// Throws ParameterError where `count` exceeds `most`: to be called before memory is taken for them.
void require_indices(uint64_t count, uint64_t most, const char* what);

}  // namespace soapfilm
