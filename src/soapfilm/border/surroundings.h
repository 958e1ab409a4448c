// How the samples lie around the scanners: in front of them, as with an object, or on all sides.
#pragma once

#include <cstddef>
#include <optional>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// How the samples lie around the scanners: in front of them, as with an object, or on all sides.
struct Surroundings {
  size_t scanners = 0;  ///< scanner positions used; 0: none is known
  size_t among = 0;     ///< how many of them stand among the samples: some samples lie beyond them in every direction
  double covered = 0;   ///< mean share of the directions around these that contain samples; 0 to 1

  /// Most scanners stand among their samples: these are no object, but surround the scanner.
  bool stand_among_samples() const { return among > 0 && 2 * among > scanners; }
  /// And they see samples in a part of the directions around them only.
  bool under_open_sky() const {
    constexpr double all_covered = 0.75;
    return stand_among_samples() && covered < all_covered;
  }
};

/// Evaluates some of the scanners' positions, and from each some of the samples, both chosen by where they are.
/// `sensor` is the position for scans without one.
Surroundings measure_surroundings(const PointCloud& cloud, const std::optional<Vec3d>& sensor, const Context& context);

}  // namespace soapfilm
