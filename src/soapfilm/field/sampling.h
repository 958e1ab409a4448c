// How densely the samples cover the surface: what the default voxel and the default lambda follow from.
#pragma once

#include "soapfilm/core/point_cloud.h"

namespace soapfilm {

struct Sampling {
  double area = 0;     ///< of the sampled surface, input units squared: an estimate within some 20 %
  size_t samples = 0;  ///< that lie on it: those in cells with at least three

  /// Samples per voxel^2 of surface.
  double density(double voxel) const { return area > 0 ? static_cast<double>(samples) * voxel * voxel / area : 0; }
  /// The voxel at which there is `density` samples per voxel^2.
  double voxel(double density) const;
};

/// Counts the cells that hold samples, at the finest scale where such a cell holds a dozen of them on average: there
/// they are the cells that the surface crosses, 1.5 per area of a cell's face averaged over orientations. Cells with
/// fewer than three samples are taken for outliers.
Sampling measure_sampling(const PointCloud& cloud);

/// A film over even samples of less than lambda / critical_density per voxel^2 costs more than it gains: the optimum
/// is empty. (Measured: design, section 2; tests/field repeats it.)
inline constexpr double critical_density = 0.27;

}  // namespace soapfilm
