// Whether a cloud can be reconstructed at all.
#pragma once

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The samples' box. Throws SamplesError unless there are at least 4 samples, all finite, that span a volume.
Box3d check_samples(const PointCloud& cloud, const Context& context);

}  // namespace soapfilm
