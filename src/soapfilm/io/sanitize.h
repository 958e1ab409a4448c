#pragma once

#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"

namespace soapfilm::io {

/// Drops and counts samples with a non-finite coordinate; makes non-finite normals and sensor positions absent (zero,
/// not-a-number); fills in report.samples. Throws InputError when no sample is left.
void drop_non_finite(PointCloud& cloud, FileReport& report);

}  // namespace soapfilm::io
