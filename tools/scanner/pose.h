// Where a scanner stands: a rigid frame.
#pragma once

#include <array>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Axes and origin of a scan's own frame in the world: +x to the right of the range image, +y up, +z from the scene
/// towards the scanner; the scanner sits at the origin. The axes are orthonormal and right-handed.
struct Pose {
  Vec3d x{1, 0, 0};
  Vec3d y{0, 1, 0};
  Vec3d z{0, 0, 1};
  Vec3d origin;

  Vec3d rotate(Vec3d v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3d to_world(Vec3d local) const { return origin + rotate(local); }
  Vec3d to_local(Vec3d world) const {
    const Vec3d d = world - origin;
    return {dot(x, d), dot(y, d), dot(z, d)};
  }

  /// Unit quaternion (x, y, z, w) of the `bmesh` lines of a Stanford .conf file. There the rotation matrix is the
  /// transpose of the textbook one, so this is the conjugate of the usual quaternion of rotate().
  std::array<double, 4> stanford_quaternion() const;
};

/// A scanner at `position` that looks at `target`, upright (+y as near to the world's z as can be).
Pose look_at(Vec3d position, Vec3d target);

}  // namespace soapfilm
