// Checks a result: topology of the mesh, and distances of the samples from it.
#pragma once

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/reconstruct.h"

namespace soapfilm {

/// Fills report.topology and report.sample_distance. With ReconstructParams::checked the run plans the memory for it.
void check_result(Reconstruction& result, const PointCloud& cloud, const Context& context);

}  // namespace soapfilm
