// Planes of samples whose neighbors lie along a line: rings of a spinning scanner, lines of a flight, profiles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// For each of the `wanted` points a unit normal (sign arbitrary), or zero where there is no plane around it. The
/// points are replaced by the mean positions in cells, twice as large from step to step, up to a 64th of the box; the
/// plane is that of the nearest dozen of means at the first step where these span more than a line. So the
/// neighborhood reaches across the gaps between lines, as far as it must, and many samples on one line count as few.
/// What is found there must be flat: otherwise the point has none. Does not depend on the number of threads.
std::vector<Vec3f> far_planes(std::span<const Vec3d> points, std::span<const uint32_t> wanted, const Context& context);

}  // namespace soapfilm
