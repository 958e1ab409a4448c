// Whether a triangle has an area.
#pragma once

#include <algorithm>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Height over longest side up to which a triangle counts as without area: far above rounding, far below any useful
/// one.
inline constexpr double flat_height = 1e-12;

/// By two sides from one corner. False where a coordinate is not a number.
inline bool has_area(Vec3d ab, Vec3d ac) {
  const Vec3d bc = ac - ab;
  return norm(cross(ab, ac)) > flat_height * std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
}

}  // namespace soapfilm
