// Closed parts of a mesh that are inside out.
#pragma once

#include <cstddef>

#include "soapfilm/mesh.h"

namespace soapfilm {

/// Removes closed parts of negative volume: bubbles of air in solid matter that nobody saw from within. A part with at
/// least half of the mesh's area is a room, and stays. Returns how many were removed; attributes are dropped if any
/// was.
size_t drop_shells(Mesh& mesh);

}  // namespace soapfilm
