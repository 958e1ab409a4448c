// A second look at a result: what the mesh is as a surface, and how far the samples lie from it.
#pragma once

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/reconstruct.h"

namespace soapfilm {

/// Fills report.topology and report.sample_distance. ReconstructParams::checked lets the run plan its memory.
void check_result(Reconstruction& result, const PointCloud& cloud, const Context& context);

}  // namespace soapfilm
