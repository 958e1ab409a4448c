// Does the mesh contain what was sampled, and nothing else? Checks a part of both, cheap enough for every run.
#pragma once

#include <cstddef>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Voxels: much more than noise and rounding move a surface.
inline constexpr double self_check_reach = 3;

/// Share of lost samples above which a warning is given.
inline constexpr double self_check_most_lost = 0.01;

/// Checks all samples where there are at most 20 000, else 10 000 to 20 000 of them chosen at random; and 10 000 to 20
/// 000 points of the surface, each against all samples. The random seed is fixed: the same input gives the same
/// figures, for any number of threads. Standard error of a share s at most sqrt(s / 10 000). Everything is lost when
/// the mesh has no area.
SelfCheckReport self_check(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                           const Context& context);

}  // namespace soapfilm
