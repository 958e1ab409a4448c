// Holes in the sampling: the film of least area spans them flat; here it bends as the surface around it does.
//
// On every second vertex, where no sample is near: the fit of refine/displacement.h with its curvature term, signs that
// follow it at simple points, and again from there, since one fit moves a surface by no more than its band is wide.
#pragma once

#include <vector>

#include "soapfilm/refine/hole_finder.h"
#include "soapfilm/refine/strength.h"

namespace soapfilm {

/// Bends the surface of u > threshold at these films; `level` becomes a binary indicator (its box, grid, u and inside
/// alone), `start` the start from it. Components and genus stay. `strength` is what the samples of the whole grid are
/// fitted with. Bulges end at the grid's border; where more than 3 % of the vertices that want to turn may not, all
/// stays as it was. Results do not depend on threads.
void bend_holes(Level& level, float threshold, const std::vector<Vec3i>& film, const HoleFinder& finder,
                const Strength& strength, Start& start, const GridSamples& samples, double reach,
                const Parallel& parallel, HoleReport& report);

}  // namespace soapfilm
