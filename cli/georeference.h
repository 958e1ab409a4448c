// Places of a map or a survey on the globe.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "soapfilm/vec.h"

namespace soapfilm::cli {

/// A frame on the ellipsoid: x east, y north, z up, meters.
struct EarthFrame {
  std::array<double, 16> to_earth;  ///< column by column: from the frame to earth-centered coordinates (EPSG:4978)
};

/// Moves points from a coordinate system (WKT or "EPSG:NUMBER") into the frame that stands below their `center`, one of
/// them or near. Heights are taken as above the ellipsoid of WGS 84, in the unit of the system.
/// Throws ParameterError for a system that is not understood or a point outside of it, and where the program was built
/// without PROJ.
EarthFrame move_to_earth(const std::string& system, Vec3d center, std::vector<Vec3d>& points);

/// Whether this program was built with PROJ.
bool knows_earth();

}  // namespace soapfilm::cli
