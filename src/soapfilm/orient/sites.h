// The different positions of a cloud, and planes through some of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The different positions, relative to their least coordinates to keep precision at large offsets. They are stored
/// along a Morton curve: what is near in space is near in memory, or on disk.
class Sites {
 public:
  Sites(const std::vector<Vec3d>& positions, const Context& context);

  size_t size() const { return points_.size(); }
  const std::vector<Vec3d>& points() const { return points_; }
  const Vec3d& operator[](size_t site) const { return points_[site]; }
  uint32_t of_sample(size_t sample) const { return of_sample_[sample]; }

  /// Another order, where one is chosen among equals: it follows from the places alone, whatever the order of the
  /// samples and of the axes.
  uint64_t lot(uint32_t site) const;
  bool before(uint32_t a, uint32_t b) const;

 private:
  std::vector<Vec3d> points_;
  std::vector<uint32_t> of_sample_;
  Box3d box_;
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
