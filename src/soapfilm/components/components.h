// Removes components and cavities supported by too few samples, such as those that outliers cause.
#pragma once

#include <cstddef>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/params.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const ComponentParams& params);

/// What users set, and what follows from other parameters.
struct ComponentSetup : ComponentParams {
  bool open = false;  ///< the surface may end at the border of the box: parts that reach it stay
};

/// Gives the parts of u > threshold (components/parts.h) that their samples do not support to the part around them,
/// cavities as well as components: there u becomes 0 or 1. `density` is in samples per voxel^2 of surface. A sample
/// supports the surface that it lies on if its direction crosses it from inside to outside, by its weight. If no
/// component would stay, the one with most samples does. Doing it twice changes nothing more; the result does not
/// depend on the number of threads.
void drop_components(Labels& labels, const GridSamples& samples, double density, const ComponentSetup& params,
                     const Context& context, ComponentReport& report);

}  // namespace soapfilm
