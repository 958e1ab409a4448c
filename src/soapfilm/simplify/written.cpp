#include "soapfilm/simplify/written.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/farthest.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

/// The smallest power of two that is not below.
double power_of_two_above(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(1.0, mantissa == 0.5 ? exponent - 1 : exponent);
}

double multiple_of(double step, double value) { return std::nearbyint(value / step) * step; }

/// About the edge of a triangle of mean area. Long triangles make it larger, so that a grid of such cells has a few for
/// each triangle, whatever the mesh.
double typical_edge(const Mesh& mesh, double longest_side) {
  double length = 0, area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    length += norm(b - a) + norm(c - b) + norm(a - c);
    area += 0.5 * norm(cross(b - a, c - a));
  }
  const auto count = static_cast<double>(mesh.triangles.size());
  return std::max({1.4 * std::sqrt(area / count), length / (6 * count), longest_side * 0x1p-18});
}

constexpr double float_share = 1.0 / 64;         // of the tolerance, that rounding to float may take of it
constexpr double float_share_of_edge = 0x1p-10;  // so that triangles keep their shape

}  // namespace

Written::Written(const Mesh& mesh, double tolerance, double edge) {
  const Box3d box = mesh.box();
  const double largest = power_of_two_above(farthest_coordinate(box));
  double rounding = 0;
  for (const Vec3d& v : mesh.vertices) {
    const Vec3d d = v - static_cast<Vec3d>(static_cast<Vec3f>(v));
    rounding = std::max({rounding, std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  }
  const double typical = typical_edge(mesh, box.longest());
  single_ = rounding <= std::min(float_share * tolerance, float_share_of_edge * typical);
  // 2^38 steps hold every float but those near zero, which lose what is far below the others' precision.
  step_ = single_ ? largest * 0x1p-38 : std::max(power_of_two_above(box.longest()) * 0x1p-37, largest * 0x1p-52);
  unit_ = std::max(
      power_of_two_above(edge > 0 ? std::max(edge, box.longest() * 0x1p-18) : std::max(typical, 1.5 * tolerance)),
      step_);
  per_unit_ = 1 / unit_;
  steps_per_unit_ = unit_ / step_;
  const Vec3d center = box.center();
  origin_ = {multiple_of(step_, center.x), multiple_of(step_, center.y), multiple_of(step_, center.z)};
  for (const Vec3d& v : mesh.vertices) moved_ = std::max(moved_, norm(v - rounded(v)));
  // A float's digits in a text name it to half a unit of its last place.
  slack_ = (single_ ? largest * 0x1p-24 : largest * 0x1p-52) + box.longest() * 1e-13;
}

Vec3d Written::rounded(Vec3d world) const {
  if (single_) world = static_cast<Vec3d>(static_cast<Vec3f>(world));
  return {multiple_of(step_, world.x), multiple_of(step_, world.y), multiple_of(step_, world.z)};
}

}  // namespace soapfilm
