// Holes in the sampling: the surface of least area spans them flat; here it gets the curvature of the surface around.
//
// On the half-resolution grid, where no sample is near: the fit of refine/displacement.h with its curvature term, label
// changes that follow it at simple points, and this repeated, since one fit moves a surface at most by the width of its
// band.
#pragma once

#include "soapfilm/refine/choose/fit_weights.h"
#include "soapfilm/refine/holes/hole_finder.h"
#include "soapfilm/refine/holes/hole_report.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// Makes room for bulges beyond the solve's border: frees the vertices up to the lattice's first one, and as many on
/// the high side. Labels do not change; the box of bricks may grow.
void make_room(Labels& labels);

/// Curves the surface over these holes, which `finder` found; returns whether any label changed. Components and genus
/// stay; only the bricks near the surface are kept.
/// `fit_weights`: those of the samples on the full grid.
/// A hole stays as it was where the topology refuses more than 6 % of the changes, where it would bulge by much more
/// than half a ball on its area, and where it still moves in the last round: the underside of a table would reach the
/// floor. Bulges end at the border of the box. Results do not depend on threads.
bool curve_holes(Labels& labels, const std::vector<HoleSurface>& holes, const HoleFinder& finder,
                 const FitWeights& fit_weights, const Context& context, HoleReport& report);

}  // namespace soapfilm
