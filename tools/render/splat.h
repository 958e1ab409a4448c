// How large to draw a sample.
#pragma once

#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm::render_detail {

/// Radius at which discs around the samples just close the surface between them: from the median, over a thousand
/// samples, of the distance to the fourth neighbor. Input units, > 0.
double splat_radius(const std::vector<Vec3d>& positions);

}  // namespace soapfilm::render_detail
