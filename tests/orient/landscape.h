// Surfaces over a plane as bare positions, and closed bodies: from where were they seen?
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"

namespace soapfilm::test {

/// Positions, and the true normal on the side from which the surface was seen.
struct Seen {
  std::vector<Vec3d> positions;
  std::vector<Vec3d> normals;

  void add(Vec3d position, Vec3d normal) {
    positions.push_back(position);
    normals.push_back(normal);
  }
};

/// A height over [-1, 1] x [-1, 1] and its derivatives.
struct Height {
  double z, dx, dy;
};
using Landscape = std::function<Height(double x, double y)>;

/// Samples uniform by area, each moved along its normal by `noise` (standard deviation).
inline Seen seen_from_above(const Landscape& height, size_t count, double noise = 0, uint64_t seed = 1) {
  constexpr double steepest = 8;  // no derivative is larger
  Random random(seed);
  Seen seen;
  while (seen.positions.size() < count) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    const Height h = height(x, y);
    const double area = std::sqrt(1 + h.dx * h.dx + h.dy * h.dy);
    if (random.uniform() * std::sqrt(1 + 2 * steepest * steepest) > area) continue;
    const Vec3d normal = Vec3d{-h.dx, -h.dy, 1} / area;
    seen.add(Vec3d{x, y, h.z} + normal * (noise * random.normal()), normal);
  }
  return seen;
}

/// The landscapes that look most alike from both sides, or least like a layer.
inline std::vector<std::pair<std::string, Landscape>> landscapes() {
  const auto round = [](double sign) {
    return [sign](double x, double y) { return Height{sign * 0.5 * (x * x + y * y), sign * x, sign * y}; };
  };
  const auto wave = [](double sign) {
    return [sign](double x, double) { return Height{sign * 0.5 * std::cos(3 * x), -sign * 1.5 * std::sin(3 * x), 0}; };
  };
  return {{"plane",
           [](double, double) {
             return Height{0, 0, 0};
           }},
          {"bowl", round(1)},
          {"dome", round(-1)},
          {"valley", wave(-1)},
          {"hill", wave(1)},
          {"cliff", [](double x, double) {
             const double t = std::tanh(8 * x);  // flat, a face of 78 degrees, flat
             return Height{0.6 * t, 4.8 * (1 - t * t), 0};
           }}};
}

/// Turned by an angle, degrees, about the x axis.
inline Seen tilted(Seen seen, double degrees) {
  const double angle = degrees / 57.29577951308232, c = std::cos(angle), s = std::sin(angle);
  for (auto* column : {&seen.positions, &seen.normals})
    for (Vec3d& v : *column) v = {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
  return seen;
}

/// Turned so that what looked along +z looks along an axis: 0, 1, 2 for x, y, z, and 3, 4, 5 for the opposite ones.
inline Seen turned_up(Seen seen, int axis) {
  const int shift = 2 - axis % 3;
  for (auto* column : {&seen.positions, &seen.normals})
    for (Vec3d& v : *column) {
      if (axis >= 3) v = {v.x, -v.y, -v.z};
      v = permuted(v, shift);
    }
  return seen;
}

inline PointCloud bare(const Seen& seen) {
  PointCloud cloud;
  cloud.positions = seen.positions;
  cloud.scans.push_back({"test", 0, cloud.size(), {}, {}, {}});
  return cloud;
}

/// Share of the samples whose direction is on the side of their normal.
inline double on_the_right_side(const std::vector<Vec3f>& directions, const std::vector<Vec3d>& normals) {
  size_t right = 0;
  for (size_t i = 0; i < normals.size(); ++i) right += dot(static_cast<Vec3d>(directions[i]), normals[i]) > 0;
  return static_cast<double>(right) / static_cast<double>(normals.size());
}

}  // namespace soapfilm::test
