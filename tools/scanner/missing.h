// Samples that are not there: a hole, and a half that was measured sparsely.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "tools/scanner/surface.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {

struct MissingParams {
  double hole = 0;       ///< share of the surface's area, a connected patch (SurfacePatch), without samples; [0, 0.9]
  double sparse_half = 1;  ///< one of this many samples stays beyond the middle of the box's longest side; >= 1, 1: all
  uint64_t seed = 1;
};

/// What PointCloud::filter() is to keep of samples taken from `surface`. A sample is in the hole when the point of the
/// surface closest to it is. Throws ParameterError when a parameter is out of range or no sample would stay.
std::vector<bool> kept_samples(const Surface& surface, const PointCloud& cloud, const MissingParams& params,
                               const Context& context);

/// PointCloud::filter() for scans with poses: a scan that lost all of its samples takes its pose along.
void filter(ScanSet& set, const std::vector<bool>& keep);

}  // namespace soapfilm
