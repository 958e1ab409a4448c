// The different positions of a cloud, and planes through some of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The different positions, relative to their least coordinates to keep precision at large offsets, in an order that
/// follows from the places alone, whatever the order of the samples and of the axes.
struct Sites {
  std::vector<Vec3d> points;
  std::vector<uint32_t> of_sample;

  explicit Sites(const std::vector<Vec3d>& positions);
};

/// Normal of the plane through points around a center (sign arbitrary), and how well they fit it.
struct Plane {
  Vec3d normal;       ///< zero when the points lie on a line or in one place
  double flat = 1.0;  ///< thickness: least over middle variance, 0 for a plane
  double wide = 0.0;  ///< middle over largest variance: 0 for a line, 1 for a disk
};

/// Principal component analysis of the center and the `chosen` points (Hoppe et al. 1992).
Plane fit_plane(std::span<const Vec3d> points, Vec3d center, std::span<const uint32_t> chosen);

/// Below this Plane::wide points lie along a line, as those of one ring of a scanner do: their plane means nothing.
inline constexpr double least_wide = 0.04;

}  // namespace soapfilm
