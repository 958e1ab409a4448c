#include "tools/scanner/pose.h"

#include <cmath>

namespace soapfilm {

std::array<double, 4> Pose::stanford_quaternion() const {
  // Shepperd's method (1978) on the matrix R with columns x, y, z: of the four components the largest comes from a
  // square root, the others from sums and differences of R's entries. Their signs give the conjugate.
  const double trace = x.x + y.y + z.z;
  std::array<double, 4> q;
  if (trace > 0.0) {
    q = {z.y - y.z, x.z - z.x, y.x - x.y, 1.0 + trace};
  } else if (x.x >= y.y && x.x >= z.z) {
    q = {-(1.0 + x.x - y.y - z.z), -(y.x + x.y), -(z.x + x.z), y.z - z.y};
  } else if (y.y >= z.z) {
    q = {-(y.x + x.y), -(1.0 - x.x + y.y - z.z), -(z.y + y.z), z.x - x.z};
  } else {
    q = {-(z.x + x.z), -(z.y + y.z), -(1.0 - x.x - y.y + z.z), x.y - y.x};
  }
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) c /= length;
  return q;
}

Pose look_at(Vec3d position, Vec3d target) {
  Pose pose;
  pose.origin = position;
  pose.z = normalized(position - target);
  const Vec3d up = std::abs(pose.z.z) < 0.999 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
  pose.x = normalized(cross(up, pose.z));
  pose.y = cross(pose.z, pose.x);
  return pose;
}

}  // namespace soapfilm
