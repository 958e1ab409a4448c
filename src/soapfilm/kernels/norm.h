// How the area of the surface is measured: the norm in TV(u) = sum over vertices of |grad u|.
#pragma once

#include "soapfilm/params.h"

namespace soapfilm {

// The dual of the isotropic norm is a ball, |p| <= lambda; of the anisotropic one a cube, |p_k| <= lambda. With the
// anisotropic norm a surface diagonal to the grid costs up to sqrt(3) times one along it, so the result has steps; but
// the coarea formula holds exactly: the thresholded optimum is an optimum, the one that graph-cut-6 finds.

/// Mean over all directions of the cost of a unit area: for a unit normal n, the mean of |nx| + |ny| + |nz|.
constexpr double mean_area(Norm norm) { return norm == Norm::isotropic ? 1.0 : 1.5; }

}  // namespace soapfilm
