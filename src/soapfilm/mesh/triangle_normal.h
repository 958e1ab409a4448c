// The normal of a triangle, and whether it has one.
#pragma once

#include <algorithm>
#include <cstdint>

#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Height over longest side up to which a triangle counts as without area: far above rounding, far below any useful
/// one.
inline constexpr double flat_height = 1e-12;

/// By two sides from one corner. False where a coordinate is not a number.
inline bool has_area(Vec3d ab, Vec3d ac) {
  const Vec3d bc = ac - ab;
  return norm(cross(ab, ac)) > flat_height * std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
}

/// Unit normal, towards the side from which the corners run counter-clockwise. Zero for a triangle without area:
/// rounding would choose it.
inline Vec3d triangle_normal(const Mesh& mesh, uint32_t index) {
  const Triangle& t = mesh.triangles[index];
  const Vec3d a = mesh.vertices[t[0]];
  const Vec3d ab = mesh.vertices[t[1]] - a, ac = mesh.vertices[t[2]] - a;
  return has_area(ab, ac) ? normalized(cross(ab, ac)) : Vec3d{};
}

}  // namespace soapfilm
