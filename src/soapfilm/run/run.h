// The page of reconstruct.cpp, for our own programs and measurements.
#pragma once

#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/refine/robust_fit.h"

namespace soapfilm {

/// What is looked at or varied beyond the parameters.
struct Experiment {
  PyramidObserver observe;  ///< sees the levels of Method::tv
  RobustParams robust;      ///< of the refinement: fixed by measurement (bench/results/penalties.md)
};

/// As reconstruct(). `owned`: the cloud, when it may be freed once its samples are on the grid; or null.
Reconstruction run(const PointCloud& cloud, PointCloud* owned, const ReconstructParams& params, const Context& context,
                   const Experiment& experiment = {});

}  // namespace soapfilm
