// Vertices whose label may change without changing the topology of the surface.
#pragma once

#include <cstdint>

namespace soapfilm {

/// The 27 vertices around a vertex, itself in the middle, as bits: (dx + 1) + 3 (dy + 1) + 9 (dz + 1), set where
/// inside.
using Neighborhood = uint32_t;

/// Whether changing the label of the middle vertex, from either side, keeps the components, tunnels and cavities of the
/// inside (6-connected) and of the outside (26-connected): the connectivity of extract_isosurface. True when both sides
/// have exactly one component there that touches the vertex (Bertrand and Malandain 1994). The middle bit does not
/// matter.
bool is_simple(Neighborhood inside);

/// Whether the middle vertex is a component by itself: of the inside (6-connected), or of the outside (26-connected).
/// If its label changes, that component vanishes, and nothing else of the topology changes.
bool is_alone(Neighborhood inside);

}  // namespace soapfilm
