// How densely the samples cover the surface: the default voxel and the default lambda are computed from it.
#pragma once

#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

struct Sampling {
  double per_area = 0;    ///< samples per area of surface, input units^-2, averaged over the samples
  size_t repeats = 0;     ///< samples at the place of another one, left out if they would hide the density
  Vec3d most_repeated{};  ///< the place with most of them

  /// Samples per voxel^2 of surface.
  double density(double voxel) const { return per_area * voxel * voxel; }
  /// The voxel at which there are `density` samples per voxel^2; 0 if nothing was measured.
  double voxel(double density) const;
};

/// From the number of other samples in a sample's cell, at the finest scale where there are four on average: the cell
/// then holds 0.94 of its face's area of surface, averaged over the places and directions in which a plane crosses it.
/// Fine enough to separate the two sides of a thin plate; outliers, alone in their cells, have almost no effect.
/// Samples at exactly the same place, such as the (0, 0, 0) of a camera's pixels without depth, are in the same cell at
/// every scale: if they would change the result, each place counts once.
Sampling measure_sampling(const PointCloud& cloud, const Context& context);
/// The same for a cloud whose box is known, all of it.
Sampling measure_sampling(const PointCloud& cloud, const Box3d& box, const Context& context);

/// The same where clusters of nearly coinciding samples hide the surface's own density.
struct ThinnedSampling {
  Sampling sampling;           ///< of one sample from each occupied cell; nothing measured: no such cells were found
  std::vector<float> weights;  ///< of each sample: 1 over the number of samples in its cell
  double crowded = 0;          ///< share of the cells that hold more than four samples
};

/// Of the samples only one is kept from each cell of a grid, from coarse grids to fine ones. While the cells are larger
/// than the spacing the kept samples are about one cell apart; the first grid on which they are clearly farther apart
/// shows the spacing on most of the area. Clusters count as one sample there, and outliers alone do not matter.
ThinnedSampling measure_thinned(const PointCloud& cloud, const Box3d& box, const Context& context);

/// A surface over even samples with less than lambda / critical_density per voxel^2 costs more than it gains: the
/// optimum is empty. Measured on spheres and tori (repeated in tests/field); flat parts and edges allow slightly more.
inline constexpr double critical_density = 0.2;

}  // namespace soapfilm
