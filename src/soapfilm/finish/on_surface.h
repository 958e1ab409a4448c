// Is a sample one of a surface, or an outlier?
#pragma once

#include "soapfilm/core/vec.h"
#include "soapfilm/field/samples.h"

namespace soapfilm {

/// Whether the samples within 8 voxels of a place (lattice coordinates) are at least six and lie about in a plane or
/// along a line, as those of a surface or of one sweep over it do. Outliers are few, or fill the ball. A guess: of six
/// outliers one time in four lies so.
bool looks_like_surface(const GridSamples& samples, Vec3d place);

}  // namespace soapfilm
