// The stage that gives each sample a direction, and measures the surface around it.
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
  std::vector<Vec3f> directions;  ///< weak directions, outward: unit vectors, or zero where unknown
  std::vector<Vec3f> views;       ///< the same before normals of planes replaced them; empty where none did
  LocalSurface surface;           ///< around each sample
  OrientReport report;            ///< its warnings have been shown
};

/// Directions as orient() finds them, with contradicting signs of normals discarded, replaced by the normals of the
/// planes around the samples (DirectionSource::automatic). `box` is the cloud's. Throws as orient() does.
Orientation find_directions(const PointCloud& cloud, const Box3d& box, const OrientSetup& params,
                            const Context& context);

}  // namespace soapfilm
