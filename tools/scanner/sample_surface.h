// Samples spread evenly over a surface: input whose density is known, without a scanner's shadows.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "tools/scanner/surface.h"

namespace soapfilm {

/// `count` independent samples, uniform by area (for a shape: by the area of a tessellation that deviates from it by
/// at most 1e-4 of the longest side, moved onto the shape), as one scan with the true outward normals.
PointCloud sample_surface(const Surface& surface, size_t count, uint64_t seed);

struct SamplingParams {
  size_t count = 100000;         ///< samples, including outliers; >= 1
  double noise = 0;              ///< standard deviation along the true normal, input units, >= 0
  double outliers = 0;           ///< share of the samples that lie anywhere in outlier_box(); [0, 1]
  std::vector<Vec3d> sensors{};  ///< if given: scanner positions to choose from, and samples have no normals
  uint64_t seed = 1;
};

/// The samples above, disturbed. Each has its true outward normal, an outlier a random direction. With `sensors` each
/// has instead a scanner position, the weak orientation that scans give: of those that see its undisturbed position the
/// one with the smallest angle to the normal, or of all if none sees it; an outlier has any of them.
/// The result does not depend on the number of threads. Throws ParameterError when a parameter is out of range.
PointCloud sample_surface(const Surface& surface, const SamplingParams& params, const Context& context);

}  // namespace soapfilm
