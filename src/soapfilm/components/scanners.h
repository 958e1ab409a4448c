// Where the scanners stand in a solution: in the air, or where none can?
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Different positions of scanners, at most some 64 of them: of scans (`sensor` of those that name none) and of
/// samples.
std::vector<Vec3d> scanner_positions(const PointCloud& cloud, const std::optional<Vec3d>& sensor);

/// Looks at the vertex nearest to each position (lattice coordinates). `complement`: the level's inside is air, and
/// solid matter lies beyond its box; otherwise air does.
ScannerReport place_scanners(const Level& level, float threshold, bool complement, const std::vector<Vec3d>& positions);

}  // namespace soapfilm
