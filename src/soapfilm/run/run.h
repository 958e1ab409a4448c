// The page of reconstruct.cpp, for the calls that others see.
#pragma once

#include "soapfilm/reconstruct.h"

namespace soapfilm {

/// `owned`: the cloud, when it may be freed once its samples are on the grid; or null.
Reconstruction run(const PointCloud& cloud, PointCloud* owned, const ReconstructParams& params, const Context& context,
                   const PyramidObserver& observe);

}  // namespace soapfilm
