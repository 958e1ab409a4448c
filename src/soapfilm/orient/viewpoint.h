// From where a scene without any known direction was seen.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/orient/sites.h"

namespace soapfilm {

/// Points with the planes around them, all as long as each other.
struct PlanePoints {
  std::span<const Vec3d> points;
  std::span<const Plane> planes;
};

/// Is a part of it flat enough to be a piece of surface, not noise or vegetation?
inline bool is_flat(const Plane& plane) {
  constexpr double flat_enough = 0.05;
  return plane.flat <= flat_enough;
}

/// Are the points a layer that is wide along the two axes square to `up`, thin along it, and mostly level? As terrain
/// is, seen from the air. Measured without the outermost fiftieths, so outliers do not matter.
bool is_flat_layer(const PlanePoints& scene, Vec3d up);

/// Do level pieces lie above each other nearly everywhere, as a floor and its ceiling do? Then no place above sees
/// both.
bool is_storey(const PlanePoints& scene, Vec3d up);

}  // namespace soapfilm
