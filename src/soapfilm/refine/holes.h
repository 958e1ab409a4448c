// Holes in the sampling: the film of least area spans them flat; here it bends as the surface around it does.
//
// On every second vertex, where no sample is near: the fit of refine/displacement.h with its curvature term, signs that
// follow it at simple points, and again from there, since one fit moves a surface by no more than its band is wide.
#pragma once

#include "soapfilm/refine/hole_finder.h"
#include "soapfilm/refine/hole_report.h"
#include "soapfilm/refine/fit_weights.h"

namespace soapfilm {

/// Room for bulges beyond the solve's border: frees the vertices up to the lattice's first one, and as many on the high
/// side. What is on which side stays; the box of bricks may grow.
void make_room(Level& level);

/// Bends the surface of u > threshold at these films, which `finder` found in this level; returns whether any did.
/// `level` then becomes a binary indicator (its box, grid, u and inside alone). Components and genus stay. `fit_weights`
/// is what the samples of the whole grid are fitted with.
/// A film stays as it was where the topology holds more than 6 % as many vertices as turn, and where
/// it would bulge by much more than half a ball on its area. Bulges end at the border of the box. Results do not depend
/// on threads.
bool bend_holes(Level& level, float threshold, const std::vector<HoleFilm>& films, const HoleFinder& finder,
                const FitWeights& fit_weights, const Context& context, HoleReport& report);

}  // namespace soapfilm
