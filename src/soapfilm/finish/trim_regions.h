// Which made-up regions of a mesh go, and which stay as filled holes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/finish/trim_levels.h"
#include "soapfilm/mesh.h"
#include "soapfilm/report.h"

namespace soapfilm {

struct RegionRules {
  bool open = false;               ///< the surface may end: only gaps in a surface around them stay
  bool holes = false;              ///< none stays
  double distance = 1, voxel = 1;  ///< of the cut, input units
  std::optional<double> widest{};  ///< TrimParams::fill_holes
};

/// Sets the level of regions that stay to 0 and counts them in the report; returns whether anything remains to be cut.
/// A region is a connected set of vertices with a level over 1. It stays where it fills a gap:
///   - on a closed surface, unless it has more than a tenth of the area;
///   - on an open one it must be no wider than six times the cut's distance, must not reach the mesh's border, must not
///   be crossed by more than a few rays (`crossings`, as
///     count_crossings() has them; empty: unknown), mostly face samples, be no larger than a film across its rim, and
///     look where the surface around it looks.
/// With rules.widest its width alone decides instead of its area: the largest distance between points of its rim, plus
/// the distance of the cut on both sides. (On an open surface the other conditions stay.)
bool choose_regions(const Mesh& mesh, TrimLevels& levels, const std::vector<uint32_t>& crossings,
                    const RegionRules& rules, TrimReport& report);

}  // namespace soapfilm
