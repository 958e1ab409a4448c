// simplify() with some of its checks left out: for tests of what finds the faults.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/simplify.h"
#include "soapfilm/simplify/proof.h"

namespace soapfilm {

/// Of a run, the mesh included, measured.
constexpr uint64_t simplify_bytes(uint64_t triangles) { return 340 * triangles; }

/// Collapses of all rounds are numbered in 32 bits.
inline constexpr size_t most_simplified = size_t{1} << 28;

/// simplify_to(), but the `fixed` vertices, all of them on borders, stay in place, and so do edges of the border
/// between two of them. (The order of vertices is kept.)
Simplified simplify_to(const Mesh& mesh, size_t triangles, const std::vector<uint8_t>& fixed, const Context& context);

Simplified simplify_checked(const Mesh& mesh, double tolerance, const SimplifyChecks& checks, const Context& context);

}  // namespace soapfilm
