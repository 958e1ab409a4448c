// The surface around each sample: its plane, and the area that the sample represents.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/orient/sides.h"
#include "soapfilm/progress.h"

namespace soapfilm {

struct AreaCoverage {
  double area = 0;      ///< of surface that was seen, input units^2; 0: too little was found to be usable
  double per_area = 0;  ///< samples per area, averaged over the area, input units^-2
  double spacing = 0;   ///< of different samples, input units: it is smaller on a quarter of the area
};

/// Columns, each as long as the samples; empty when it was not measured.
struct LocalSurface {
  std::vector<float> area;     ///< of surface that the sample represents, input units^2; 0: nothing around it
  std::vector<float> spacing;  ///< of different samples around it, input units; 0: the same, or an outlier, such as
                               ///< where the directions around contradict each other
  std::vector<Vec3f> normal;   ///< unit, sign arbitrary; zero: no plane
  std::vector<uint8_t> line;   ///< 1: the samples near this one lie along a line, such as a scanner's ring
  size_t planes = 0;           ///< samples with both a normal and a spacing
  AreaCoverage coverage;       ///< of all of them
  SideStatistics sides;        ///< of those whose directions agree on their side

  /// Does the sample lie on a plane whose samples agree on its sides?
  bool is_plane(size_t i) const { return normal[i] != Vec3f{} && spacing[i] > 0; }
};

/// Examines the samples in cells of an octree, from fine to coarse. A sample has its plane at the smallest cells where
///   - the 27 cells around it include at least six with samples, spread along two axes, and
///   - the mean positions in these, each cell counted once, lie in a plane (principal component analysis).
/// So neither many samples along one ring of a scanner nor copies of samples are taken for a surface, and neither noise
/// nor a change of density leads to a wrong scale. Planes whose samples would represent much more than the mean area
/// must also be found at cells twice as large: this excludes few outliers in a plane. `directions`, as long as
/// `positions`, separate the two sides of a sheet: samples seen from the other side count neither for the area nor,
/// where no plane is found with them, for the plane. Does not depend on the number of threads.
LocalSurface measure_local_surface(std::span<const Vec3d> positions, std::span<const Vec3f> directions,
                                   const Box3d& box, const Context& context);

}  // namespace soapfilm
