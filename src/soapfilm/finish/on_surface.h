// Does a sample lie on a surface, or is it an outlier?
#pragma once

#include <cstdint>

#include "soapfilm/core/vec.h"
#include "soapfilm/field/samples.h"

namespace soapfilm {

/// What the samples within 8 voxels of a place show.
enum class Company : uint8_t {
  few,       ///< fewer than six: those of an outlier, or of a part that is sampled too thinly
  surface,   ///< roughly in a plane or along a line, like those of a surface or of one scan line over it
  scattered  ///< neither, as in the crown of a tree
};

/// Of a place in lattice coordinates. A guess: of six outliers, one case in four passes for a surface.
Company company_of(const GridSamples& samples, Vec3d place);

}  // namespace soapfilm
