// The normal of a triangle, and whether it has one.
#pragma once

#include <cstdint>

#include "soapfilm/core/has_area.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Unit normal, towards the side from which the corners run counter-clockwise. Zero for a triangle without area:
/// rounding would choose it.
inline Vec3d triangle_normal(const Mesh& mesh, uint32_t index) {
  const Triangle& t = mesh.triangles[index];
  const Vec3d a = mesh.vertices[t[0]];
  const Vec3d ab = mesh.vertices[t[1]] - a, ac = mesh.vertices[t[2]] - a;
  return has_area(ab, ac) ? normalized(cross(ab, ac)) : Vec3d{};
}

}  // namespace soapfilm
