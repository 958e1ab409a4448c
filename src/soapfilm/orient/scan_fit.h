// Whether scans that overlap show one surface, or were never brought into one frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"

namespace soapfilm {

struct ScanFit {
  size_t overlap = 0;        ///< samples, of some that were looked at, that lie before or behind another scan's surface
  size_t contradicting = 0;  ///< of these: too far from it, or turned away from it

  double share() const { return overlap == 0 ? 0 : static_cast<double>(contradicting) / static_cast<double>(overlap); }
};

/// Looks at some samples of some scans. `directions`, as long as the cloud, tell the sides of thin things apart.
ScanFit compare_scans(const PointCloud& cloud, std::span<const Vec3f> directions, const Context& context);

/// A warning for scans that mostly contradict each other where they overlap; else none.
std::optional<std::string> misfit_of_scans(const PointCloud& cloud, std::span<const Vec3f> directions,
                                           const Context& context);

}  // namespace soapfilm
