// The box around points.
#pragma once

#include <span>

#include "soapfilm/vec.h"

namespace soapfilm {

inline Box3d box_of(std::span<const Vec3d> points) {
  Box3d box;
  for (const Vec3d& p : points) box.extend(p);
  return box;
}

}  // namespace soapfilm
