#pragma once

#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"

namespace soapfilm::io {

/// Drops and counts samples with a non-finite coordinate; replaces non-finite normals and sensor positions by their
/// values for absent (zero, not-a-number); fills in report.samples. Throws InputError when no sample is left.
void drop_non_finite(PointCloud& cloud, FileReport& report);

}  // namespace soapfilm::io
