// Colors: conversions, the map for attribute values, the palette for scans.
#pragma once

#include "soapfilm/cloud.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Linear light of an sRGB color, each channel in [0, 1].
Vec3f to_linear(Rgb8 color);
/// Nearest sRGB color; channels beyond [0, 1] are clipped.
Rgb8 to_srgb(Vec3f linear);

/// Dark violet over blue and green to yellow with lightness rising evenly, t in [0, 1] (clipped); gray for
/// not-a-number. Like viridis (van der Walt and Smith 2015), interpolated between five colors in the Oklab space.
Rgb8 map_color(double t);

/// Well-separated colors of similar lightness; repeats after a dozen.
Rgb8 palette_color(size_t index);

}  // namespace soapfilm
