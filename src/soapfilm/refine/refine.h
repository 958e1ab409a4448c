// From the thresholded solve to a surface that lies on the samples: sub-voxel accuracy without a change of topology.
#pragma once

#include <cstdint>
#include <optional>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/indicator.h"
#include "soapfilm/refine/robust_fit.h"
#include "soapfilm/refine/strength.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

struct RefineParams {
  std::optional<double> smoothing;  ///< gamma, in [1e-6, 1e6]; without it: chosen by held-out samples
  std::optional<double> normals;    ///< weight of a direction against a position, >= 0; without it: chosen
  RobustParams robust;
  double reach = 2.3;               ///< half width of the band, voxels
};

struct RefineReport {
  Strength strength;
  StrengthReport search;
  size_t band_vertices = 0;
  size_t band_slots = 0;
  size_t cells = 0;
  size_t down_weighted = 0;  ///< samples of weight < 1/4
  size_t flips = 0;
  size_t refused = 0;
  int iterations = 0;
};

/// Moves the level set of the binary indicator u > threshold onto the samples. The level set 0 of the result is the
/// surface; positive inside, about the signed distance in voxels near it.
SurfaceField refine(const Level& level, float threshold, const GridSamples& samples, const RefineParams& params,
                    const Parallel& parallel, RefineReport& report);

}  // namespace soapfilm
