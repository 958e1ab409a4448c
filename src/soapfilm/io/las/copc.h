// COPC 1.0: LAZ 1.4 whose chunks are the nodes of an octree. Each level halves the distance between points.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/las/laz_layout.h"

namespace soapfilm::io {

struct CopcLevels {
  int kept = 0, all = 0;  ///< levels 0 to kept - 1 of `all`
  double spacing = 0;     ///< between the points of the last one that is kept, input units
  uint64_t points = 0;    ///< of these levels
};

/// Leaves only the chunks of the levels down to the first one whose points are at most `spacing` apart. `record`: the
/// content of the file's record of COPC. Nothing, and all chunks stay, if its octree does not name each chunk once.
std::optional<CopcLevels> keep_copc_levels(const ByteSource& source, std::string_view record, double spacing,
                                           LazLayout& layout);

}  // namespace soapfilm::io
