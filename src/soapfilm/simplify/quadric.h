// Squared distances to planes, summed (Garland and Heckbert 1997, Surface simplification using quadric error metrics).
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Symmetric 3 x 3 matrix: rows xx xy xz, yy yz, zz.
struct Symmetric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  Vec3d operator*(Vec3d v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  /// By Cramer's rule; nothing where it is singular.
  std::optional<Symmetric> inverse() const {
    const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const double determinant = xx * a + xy * b + xz * c;
    if (!(determinant > 1e-30)) return {};
    const double d = 1 / determinant;
    return Symmetric{a * d, b * d, c * d, (xx * zz - xz * xz) * d, (xy * xz - xx * yz) * d, (xx * yy - xy * xy) * d};
  }
};

/// The sum of weight * (distance to a plane)^2, positive semi-definite.
class Quadric {
 public:
  /// The plane through `point` with the unit normal.
  void add_plane(Vec3d normal, Vec3d point, double weight) {
    const double d = -dot(normal, point);
    const Vec3d n = normal * weight;
    a_.xx += n.x * normal.x;
    a_.xy += n.x * normal.y;
    a_.xz += n.x * normal.z;
    a_.yy += n.y * normal.y;
    a_.yz += n.y * normal.z;
    a_.zz += n.z * normal.z;
    b_ += n * d;
    c_ += weight * d * d;
    weight_ += weight;
  }
  Quadric& operator+=(const Quadric& o) {
    a_.xx += o.a_.xx;
    a_.xy += o.a_.xy;
    a_.xz += o.a_.xz;
    a_.yy += o.a_.yy;
    a_.yz += o.a_.yz;
    a_.zz += o.a_.zz;
    b_ += o.b_;
    c_ += o.c_;
    weight_ += o.weight_;
    return *this;
  }
  double at(Vec3d p) const { return std::max(dot(p, a_ * p) + 2 * dot(b_, p) + c_, 0.0); }
  /// Half of its gradient.
  Vec3d slope(Vec3d p) const { return a_ * p + b_; }
  /// Its matrix with `pull` added to the diagonal.
  Symmetric matrix(double pull) const {
    Symmetric s = a_;
    s.xx += pull;
    s.yy += pull;
    s.zz += pull;
    return s;
  }
  double weight() const { return weight_; }

 private:
  Symmetric a_;
  Vec3d b_;
  double c_ = 0, weight_ = 0;
};

}  // namespace soapfilm
