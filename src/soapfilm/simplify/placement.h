// Where the vertex of a collapsed edge goes, and in which order edges collapse.
#pragma once

#include <span>

#include "soapfilm/core/vec.h"
#include "soapfilm/simplify/quadric.h"

namespace soapfilm {

/// The order of collapses: the least sum of both ends' quadrics near the edge, plus a little for its length.
double collapse_cost(const Quadric& sum, Vec3d a, Vec3d b);

/// The place of least quadric error near the edge a b that leaves the enclosed volume as it is (Lindstrom and Turk
/// 1998, Fast and memory efficient polygonal simplification). `star`: corners of all triangles at a and b.
struct StarCorners {
  Vec3d a, b, c;
};
Vec3d place_keeping_volume(const Quadric& sum, Vec3d a, Vec3d b, std::span<const StarCorners> star);

}  // namespace soapfilm
