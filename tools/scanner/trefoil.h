// The curve inside the knot, in units of the minor radius of the torus that carries it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

inline constexpr double trefoil_ring = 2.0;  ///< major radius R of the torus
inline constexpr double trefoil_rise = 1.2;  ///< amplitude along z

/// Curve point ((R + cos 3 phi) cos 2 phi, (R + cos 3 phi) sin 2 phi, rise sin 3 phi) and its first two derivatives.
struct TrefoilPoint {
  Vec3d c, d1, d2;

  explicit TrefoilPoint(double phi) {
    const double cos = std::cos(phi), sin = std::sin(phi);
    const double c2 = 2.0 * cos * cos - 1.0, s2 = 2.0 * sin * cos;
    const double c3 = (2.0 * c2 - 1.0) * cos, s3 = (2.0 * c2 + 1.0) * sin;
    const double a = trefoil_ring + c3, a1 = -3.0 * s3, a2 = -9.0 * c3;
    c = {a * c2, a * s2, trefoil_rise * s3};
    d1 = {a1 * c2 - 2.0 * a * s2, a1 * s2 + 2.0 * a * c2, 3.0 * trefoil_rise * c3};
    d2 = {a2 * c2 - 4.0 * a1 * s2 - 4.0 * a * c2, a2 * s2 + 4.0 * a1 * c2 - 4.0 * a * s2, -9.0 * trefoil_rise * s3};
  }
};

/// Closest points of the curve. A table of cells holds, for each, the samples next to which the closest point of any
/// point of the cell can lie.
class TrefoilSearch {
 public:
  explicit TrefoilSearch(const Box3d& box);

  Vec3d closest(Vec3d p) const;
  /// A lower bound of the distance to the curve, and close to it.
  double lower_bound(Vec3d p) const;

 private:
  static constexpr int samples = 192;
  static constexpr double spacing = 2.0 * std::numbers::pi / samples;

  const std::vector<uint8_t>& candidates(Vec3d p) const;
  double squared_distance(size_t sample, Vec3d p) const { return dot(sample_[sample] - p, sample_[sample] - p); }
  static double refine(int sample, Vec3d p);

  std::array<Vec3d, samples> sample_;
  double reach_ = 0;  ///< no curve point is further from a sample
  Box3d box_;
  double cell_ = 0;
  Vec3i cells_;
  std::vector<std::vector<uint8_t>> table_;
  std::vector<uint8_t> all_;  ///< for points outside the box
};

}  // namespace soapfilm
