// Which side of a connected part is its outer one, where nothing but its shape tells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/orient/viewpoint.h"

namespace soapfilm {

/// Points whose planes' normals have one sign within each part; which one is the question.
struct SignedParts {
  PlanePoints scene;
  std::span<const uint32_t> part;  ///< of each point; not a part's number: the point belongs to none
  size_t count = 0;                ///< parts
};

struct OuterSides {
  std::vector<double> votes;  ///< of each part: positive where its normals look outward, negative where inward
  std::vector<uint8_t> is_sheet;
  size_t sheets_up = 0;  ///< points of sheets whose side was chosen by `up`
  size_t doubtful = 0;   ///< points of parts whose side is little more than a guess
};

/// Tells sheets from bodies: outward normals of a closed surface cancel each other (divergence theorem), those of a
/// sheet do not. A sheet's outer side is that towards `up`, unless it stands upright. Of a body, and of other sheets,
/// the extreme points in 26 directions look outward; that is right for bodies, and for a sheet a guess, for it follows
/// its curvature. Only flat points vote, not outliers; where almost none is flat, in noise, all points vote, on the
/// whole from the part's middle (the flux of x through a closed surface is three times its volume).
OuterSides find_outer_sides(const SignedParts& parts, std::optional<Vec3d> up);

}  // namespace soapfilm
