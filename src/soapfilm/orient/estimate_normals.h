// Normals from positions alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/progress.h"

namespace soapfilm {

struct NormalParams {
  int neighbors = 16;            ///< the plane is fitted to so many nearest different positions, >= 3
  std::optional<double> radius;  ///< and to all within this distance, > 0, input units
  bool inward = false;           ///< parts of unknown sign get normals that look inward, not outward
};

struct EstimatedNormals {
  std::vector<Vec3d> normals;  ///< one per wanted sample, unit; zero where the neighbors span no plane
  size_t propagated = 0;       ///< of them, how many have their sign by propagation
  size_t components = 0;       ///< connected parts over which signs were propagated
};

/// Estimates the normals of the samples `wanted` (increasing indices) from the positions around them. `hints` is as
/// long as `positions`: where a sample's hint is not zero, its normal gets the sign that agrees with it; hints of
/// samples that are not wanted contribute to the signs of their neighbors. `given`, empty or as long as `positions`:
/// normals whose signs are in doubt. Where one is not zero it replaces the estimate; where most normals of a connected
/// part look to one side, and no hint says otherwise, that side is its outer one. See orient() for the method.
EstimatedNormals estimate_normals(const std::vector<Vec3d>& positions, std::span<const uint32_t> wanted,
                                  const std::vector<Vec3f>& hints, std::span<const Vec3f> given,
                                  const NormalParams& params, const Context& context);

}  // namespace soapfilm
