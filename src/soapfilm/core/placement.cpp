#include "soapfilm/core/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace soapfilm {

Placement placement_of_quaternion(double w, double x, double y, double z) {
  const double largest = std::max({std::abs(w), std::abs(x), std::abs(y), std::abs(z)});
  w /= largest, x /= largest, y /= largest, z /= largest;  // else the squares might overflow
  const double s = 2 / (w * w + x * x + y * y + z * z);
  Placement placement;
  placement.linear = {{{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
                       {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
                       {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}}};
  return placement;
}

Placement placement_of_matrix(const std::array<double, 16>& m, std::string& error) {
  constexpr double rounding = 1e-3;  // of numbers written with few digits
  error.clear();
  for (const double value : m)
    if (!std::isfinite(value)) error = fmt::format("holds {}, must be finite numbers", value);
  if (!error.empty()) return {};
  if (std::abs(m[12]) > 1e-9 || std::abs(m[13]) > 1e-9 || std::abs(m[14]) > 1e-9 || std::abs(m[15] - 1) > 1e-9) {
    error = fmt::format("has a last row ({}, {}, {}, {}), must be (0, 0, 0, 1): a perspective cannot be used", m[12],
                        m[13], m[14], m[15]);
    return {};
  }
  Placement placement;
  placement.linear = {{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}};
  placement.translation = {m[3], m[7], m[11]};
  const auto& [a, b, c] = placement.linear;
  const double volume = dot(a, cross(b, c));
  placement.scale = std::cbrt(std::abs(volume));
  const double square = placement.scale * placement.scale;
  const auto near = [&](double value, double wanted) { return std::abs(value - wanted) <= rounding * square; };
  const bool similar = square > 0 && std::isfinite(square) && near(dot(a, a), square) && near(dot(b, b), square) &&
                       near(dot(c, c), square) && near(dot(a, b), 0) && near(dot(a, c), 0) && near(dot(b, c), 0);
  if (!similar)
    error = "stretches or shears, must be a rotation, with the same scale along all axes, and a translation";
  else if (volume < 0)
    error = "mirrors, must be a rotation and a translation: surfaces would turn inside out";
  return placement;
}

}  // namespace soapfilm
