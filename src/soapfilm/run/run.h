// The steps of reconstruct.cpp, for this project's programs and measurements.
#pragma once

#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/refine/fit/robust_fit.h"

namespace soapfilm {

/// What can be observed or varied beyond the parameters.
struct Experiment {
  PyramidObserver observe;  ///< called for the levels of Method::tv
  RobustParams robust;      ///< of the refinement: fixed by measurement (bench/results/penalties.md)
};

/// As reconstruct(). `owned`: the cloud, when it may be freed once its samples are on the grid; or null.
Reconstruction run(const PointCloud& cloud, PointCloud* owned, const ReconstructParams& params, const Context& context,
                   const Experiment& experiment = {});

/// Removes what runs with this context have kept (run/kept_stages.h), once their result is where it belongs.
void remove_kept_stages(const Context& context);

}  // namespace soapfilm
