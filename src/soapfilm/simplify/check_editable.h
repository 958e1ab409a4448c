// Is a mesh one whose edges can be edited? What connectivity.h refuses is beyond this.
#pragma once

#include <cstdint>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Throws ParameterError for coordinates that are not finite, vertices that do not exist, too many triangles, too large
/// a box; and as check_room().
void check_editable(const Mesh& mesh, const char* doing, uint64_t needed_bytes, const Context& context);

/// Throws MemoryError where what one is `doing` to the mesh takes more than there is.
void check_room(const Mesh& mesh, const char* doing, uint64_t needed_bytes, const Context& context);

}  // namespace soapfilm
