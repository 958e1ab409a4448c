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

/// Samples without any known direction were seen from above, since ...
enum class FromAbove : uint8_t {
  no,         ///< nothing says so
  survey,     ///< they are of a survey's file
  flat_layer  ///< they are a flat wide layer
};

struct NormalParams {
  int neighbors = 16;            ///< the plane is fitted to so many nearest different positions, >= 3
  std::optional<double> radius;  ///< and to all within this distance, > 0, input units
  bool inward = false;           ///< parts of unknown sign get normals that look inward, not outward
  Vec3d up{0, 0, 1};             ///< unit, an axis: where "above" is
  bool up_is_given = false;      ///< by the user: it also counts where levels lie above each other, as in a house
  bool is_survey = false;        ///< the samples are those of a survey from the air, unless they show a house
};

struct EstimatedNormals {
  std::vector<Vec3f> normals;            ///< one per wanted sample, unit; zero where the neighbors span no plane
  size_t propagated = 0;                 ///< of them, how many have their sign by propagation
  size_t components = 0;                 ///< connected parts over which signs were propagated
  FromAbove from_above = FromAbove::no;  ///< of all samples without hints
  size_t seen_from_above = 0;            ///< wanted samples whose side follows from that
  size_t sheets_up = 0;                  ///< of those propagated, in sheets that were turned towards `up`
  size_t doubtful = 0;                   ///< of those propagated, in parts whose side is little more than a guess
  size_t far_planes = 0;                 ///< samples along lines, whose plane comes from beyond their neighbors
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
