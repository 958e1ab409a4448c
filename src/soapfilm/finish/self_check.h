// Does the mesh hold what the samples saw, and only that? A look at a part of both, cheap enough for every run.
#pragma once

#include <cstddef>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Voxels: far more than noise and rounding move a surface by.
inline constexpr double self_check_reach = 3;

/// Share of lost samples that is warned of.
inline constexpr double self_check_most_lost = 0.01;

/// Looks at all samples where there are at most 20 000, else at 10 000 to 20 000 of them by lot; at 10 000 to 20 000
/// places of the surface, each against all samples. The lots are fixed: the same input gives the same figures, for any
/// number of threads. Standard error of a share s at most sqrt(s / 10 000). All is lost when the mesh has no area.
SelfCheckReport self_check(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                           const Context& context);

}  // namespace soapfilm
