// What is proved of a simplified mesh is proved of its exact coordinates.
#pragma once

#include <limits>

namespace soapfilm::cli {

/// Of WriteOptions: floats are written only where they are exact.
inline constexpr double proved_precision = std::numeric_limits<double>::min();

}  // namespace soapfilm::cli
