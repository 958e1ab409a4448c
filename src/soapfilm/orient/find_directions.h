// The stage that gives each sample a direction, and looks at the surface around it.
#pragma once

#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/orient/orient.h"

namespace soapfilm {

/// Columns, each as long as the cloud.
struct Orientation {
  std::vector<Vec3f> directions;  ///< weak, outward: unit vectors, or zero where nothing is known
  std::vector<Vec3f> views;       ///< the same before normals of planes took their place; empty where none did
  LocalSurface surface;           ///< around each sample
  OrientReport report;            ///< its warnings have been shown
};

/// Directions as orient() finds them, without the signs of normals that contradict each other, turned to the planes
/// around the samples (DirectionSource::automatic). `box` is the cloud's. Throws as orient() does.
Orientation find_directions(const PointCloud& cloud, const Box3d& box, const OrientSetup& params,
                            const Context& context);

}  // namespace soapfilm
