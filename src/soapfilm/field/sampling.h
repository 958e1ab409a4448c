// How densely the samples cover the surface: what the default voxel and the default lambda follow from.
#pragma once

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

struct Sampling {
  double per_area = 0;    ///< samples per area of surface, input units^-2, as the samples see it: the mean over them
  size_t repeats = 0;     ///< samples at another one's place, where they hid the density and were left out of it
  Vec3d most_repeated{};  ///< the place that most of them share

  /// Samples per voxel^2 of surface.
  double density(double voxel) const { return per_area * voxel * voxel; }
  /// The voxel at which there is `density` samples per voxel^2; 0 when nothing was measured.
  double voxel(double density) const;
};

/// From how many other samples share a sample's cell, at the finest scale where there are four on average: the cell
/// then holds 0.94 of its face's area of surface, averaged over where and how a plane crosses it. Fine enough to keep
/// the two sides of a thin plate apart; outliers, which share their cells with nobody, hardly count. Samples at one and
/// the same place, such as the (0, 0, 0) of a camera's pixels without depth, share cells at every scale: where they
/// matter, each place counts once.
Sampling measure_sampling(const PointCloud& cloud, const Context& context);
/// The same of a cloud whose box is known, all of it.
Sampling measure_sampling(const PointCloud& cloud, const Box3d& box, const Context& context);

/// A film over even samples of less than lambda / critical_density per voxel^2 costs more than it gains: the optimum
/// is empty. Measured on spheres and tori (tests/field repeats it); flat parts and edges stand a little more.
inline constexpr double critical_density = 0.2;

}  // namespace soapfilm
