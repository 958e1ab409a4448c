// Samples spread evenly over a surface: input for tests that sweep the sampling density.
#pragma once

#include <cstdint>

#include "soapfilm/core/point_cloud.h"
#include "soapfilm/scanner/surface.h"

namespace soapfilm {

/// `count` independent samples, uniform by area (for a shape: by the area of a tessellation that deviates from it by
/// at most 1e-4 of the longest side, moved onto the shape), as one scan with the true outward normals.
PointCloud sample_surface(const Surface& surface, size_t count, uint64_t seed);

}  // namespace soapfilm
