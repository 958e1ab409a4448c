// The properties of a point cloud that `soapfilm info` prints.
#pragma once

#include <cstddef>

#include "soapfilm/cloud.h"

namespace soapfilm {

struct CloudSummary {
  Box3d box;
  double spacing = 0;            ///< see sample_spacing()
  size_t normals = 0;            ///< samples with a normal that is not zero
  size_t sensors = 0;            ///< samples with a sensor position of their own
  size_t scans_with_sensor = 0;  ///< scans with one sensor position for all
  size_t scans_with_view_direction = 0;
  size_t scans_with_range_grid = 0;
};

CloudSummary summarize(const PointCloud& cloud);

/// Estimated distance of neighboring samples, input units: the side of a square with the area of surface per sample,
/// sqrt(pi / k) r_k with r_k the distance to the k-th neighbor, k = 8; the median over at most `queries` samples taken
/// at equal steps. 0 when there are fewer than two different positions.
double sample_spacing(const PointCloud& cloud, size_t queries = 2000);

}  // namespace soapfilm
