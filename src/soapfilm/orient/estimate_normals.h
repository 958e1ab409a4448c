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
  int neighbors = 16;           ///< whose plane it is: so many nearest different positions, >= 3
  std::optional<double> radius;  ///< and all that lie as near as this, > 0, input units
  bool inward = false;           ///< parts whose sign nothing tells look inward, not outward
};

struct EstimatedNormals {
  std::vector<Vec3d> normals;  ///< one per wanted sample, unit; zero where the neighbors span no plane
  size_t propagated = 0;       ///< of them, how many have their sign by propagation
  size_t components = 0;       ///< connected parts over which signs were propagated
};

/// Estimates the normals of the samples `wanted` (increasing indices) from the positions around them. `hints` is as
/// long as `positions`: where a sample's hint is not zero, its normal is turned to that side; hints of samples that are
/// not wanted help the signs of their neighbors. `given`, empty or as long as `positions`: normals whose signs are in
/// doubt. Where one is not zero it takes the place of the estimate; where most of a connected part look to one side,
/// and no hint says otherwise, that side is its outer one. See orient() for the method.
EstimatedNormals estimate_normals(const std::vector<Vec3d>& positions, std::span<const uint32_t> wanted,
                                  const std::vector<Vec3f>& hints, std::span<const Vec3f> given,
                                  const NormalParams& params, const Context& context);

}  // namespace soapfilm
