// Whether the scanners stand in the air in a solution, or where none can stand.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// Different positions of scanners, at most 64 of them: of samples, and of scans (`sensor` for those without a
/// position).
std::vector<Vec3d> scanner_positions(const PointCloud& cloud, const std::optional<Vec3d>& sensor);

/// Evaluates the vertex nearest to each position (lattice coordinates). `complement`: the inside is air, and
/// solid matter lies beyond the box; otherwise air does.
ScannerReport place_scanners(const Labels& labels, bool complement, const std::vector<Vec3d>& positions);

}  // namespace soapfilm
