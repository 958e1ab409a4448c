// Is a mesh one whose edges can be edited? What connectivity.h refuses is beyond this.
#pragma once

#include <cstdint>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Throws ParameterError for coordinates that are not finite, vertices that do not exist, too many triangles, too large
/// a box; MemoryError where what one is `doing` to it takes more than there is.
void check_editable(const Mesh& mesh, const char* doing, uint64_t needed_bytes, const Context& context);

}  // namespace soapfilm
