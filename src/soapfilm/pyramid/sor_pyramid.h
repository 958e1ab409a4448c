// Sections 4.2 and 4.3 as in the paper: SOR on the whole box, from the coarsest of three levels to the finest.
#pragma once

#include <vector>

#include "soapfilm/grid/lattice.h"
#include "soapfilm/solve/sor.h"

namespace soapfilm {

/// u of the next finer level by trilinear interpolation: a fine vertex lies a quarter of a cell from its coarse one
/// (weights 3/4 and 1/4 along each axis); 0 at the fixed vertices.
DenseField<float> prolong_dense(const DenseField<float>& coarse, const LevelBox& fine_box, const Context& context);

/// Equation (7) by SOR from u = 0 on the coarsest level, each result interpolated as the finer one's start; f summed to
/// the coarser levels, lambda_l = 4^l lambda, the same epsilon on all. Returns the finest level with the dual implied
/// by its u (see sor_level); it refers to `support`, the finest level's data term. `reports`: coarsest first.
Level solve_sor(const Lattice& lattice, const SupportField& support, double lambda, const SorParams& params,
                const Context& context, std::vector<SorLevelReport>& reports, const SorObserver& observe = {});

}  // namespace soapfilm
