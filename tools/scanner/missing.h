// Samples that are left out: a hole, and a half that is sparsely sampled.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "tools/scanner/surface.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {

struct MissingParams {
  double hole = 0;         ///< share of the surface's area, a connected patch (SurfacePatch), without samples; [0, 0.9]
  double sparse_half = 1;  ///< one of this many samples stays beyond the middle of the box's longest side; >= 1, 1: all
  uint64_t seed = 1;
};

/// The samples of those taken from `surface` that PointCloud::filter() shall keep. A sample is in the hole when the
/// point of the surface closest to it is. Throws ParameterError when a parameter is out of range or no sample would
/// stay.
std::vector<bool> kept_samples(const Surface& surface, const PointCloud& cloud, const MissingParams& params,
                               const Context& context);

/// PointCloud::filter() for scans with poses: a scan without remaining samples is removed together with its pose.
void filter(ScanSet& set, const std::vector<bool>& keep);

}  // namespace soapfilm
