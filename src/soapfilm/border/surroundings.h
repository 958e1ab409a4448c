// How the samples lie around the scanners: in front of them, as an object does, or on all sides.
#pragma once

#include <cstddef>
#include <optional>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// How the samples lie around the scanners: in front of them, as an object does, or on all sides.
struct Surroundings {
  size_t scanners = 0;  ///< places looked from; 0: no scanner's place is known
  size_t among = 0;     ///< of them, how many stand among the samples: some lie beyond them whichever way one looks
  double covered = 0;   ///< mean share of the directions around those, in which samples lie; 0 to 1

  /// Most scanners stand among what they saw: it is no object, it lies around them.
  bool all_around() const { return among > 0 && 2 * among > scanners; }
};

/// Looks from some of the scanners' places, spread evenly over the samples, at some of the samples, likewise. `sensor`
/// is where scanners stand whose scans do not say it.
Surroundings look_around(const PointCloud& cloud, const std::optional<Vec3d>& sensor, const Context& context);

}  // namespace soapfilm
