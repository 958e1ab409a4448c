// Whether samples that look inward are the walls of a room or the skin of a body whose normals are reversed.
#pragma once

#include <span>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Share of the directions, by length, that lie within 20 degrees of one of three axes at right angles: of the axes for
/// which it is largest, among some. Of directions that are even over the sphere 0.19. From some of the directions,
/// chosen by the places that they belong to.
double share_along_axes(std::span<const Vec3d> places, std::span<const Vec3f> directions, const Context& context);

/// Do the directions look like those of a room: floors, ceilings and walls are at least half of its surface? A body
/// with as many faces at right angles, such as a box, cannot be told from one.
bool look_along_walls(std::span<const Vec3d> places, std::span<const Vec3f> directions, const Context& context);

}  // namespace soapfilm
