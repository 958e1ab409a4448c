// Whether a cloud's columns, scans and range grids fit together.
#pragma once

#include "soapfilm/cloud.h"

namespace soapfilm {

/// Throws ParameterError for a cloud without samples, a column or a range grid of another length, and scans that do not
/// cover the samples one after the other (a cloud without scans is fine).
void check_layout(const PointCloud& cloud);

}  // namespace soapfilm
