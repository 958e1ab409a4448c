// Does a sample lie on a surface, or is it an outlier?
#pragma once

#include "soapfilm/core/vec.h"
#include "soapfilm/field/samples.h"

namespace soapfilm {

/// Whether there are at least six samples within 8 voxels of a place (lattice coordinates) that lie roughly in a plane
/// or along a line, like those of a surface or of one scan line over it. Outliers are few, or fill the ball. A guess:
/// of six outliers, one case in four passes.
bool looks_like_surface(const GridSamples& samples, Vec3d place);

}  // namespace soapfilm
