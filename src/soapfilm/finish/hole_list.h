// The parts of a surface that nobody saw, as a list: where, how wide, how large, filled or cut away.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/mesh.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Connected regions of vertices that are `unseen`, the largest first; those that reach the mesh's border are no holes.
/// A region is cut if a vertex of it is `cut` (as long as `unseen`, or empty: none is). Areas are shares of triangles
/// by their corners; the diameter is that of the rim, the seen vertices around, and of a region without a rim its own.
std::vector<HoleFacts> list_holes(const Mesh& mesh, const std::vector<uint8_t>& unseen,
                                  const std::vector<uint8_t>& cut);

}  // namespace soapfilm
