// Where a cloud's scanners stood.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm {

/// The scanner of sample i: its own, else its scan's, else `sensor`. Scans follow each other, as in a cloud.
std::optional<Vec3d> scanner_of(const PointCloud& cloud, size_t i, const std::optional<Vec3d>& sensor);

/// Different places of scanners, at most so many, chosen by where they are and not by how samples are numbered.
std::vector<Vec3d> some_scanners(const PointCloud& cloud, const std::optional<Vec3d>& sensor, size_t most);

}  // namespace soapfilm
