// From the thresholded solve to a surface that lies on the samples: sub-voxel accuracy without a change of topology.
#pragma once

#include <cstdint>
#include <optional>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/indicator.h"
#include "soapfilm/refine/robust.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

struct RefineParams {
  std::optional<double> smoothing;  ///< gamma, in [1e-6, 1e6]; without it: chosen by held-out samples
  std::optional<double> normals;    ///< weight of a direction against a position; without it: chosen
  Penalty penalty = Penalty::tukey;
  int reweightings = 3;             ///< rounds of the robust penalty, in [1, 20]
  double reach = 2.3;               ///< half width of the band, voxels
  double slope_a = 0.05;
  double slope_p = 0.5;
  double least_scale = 0.02;
  int iterations = 40;
  double tolerance = 1e-2;
};

struct RefineReport {
  double smoothing = 0;  ///< gamma
  double slope = 0;
  double normals = 0;    ///< weight of a direction against a position; 0: not used
  double noise = 0;      ///< estimated standard deviation of the samples along the normal, voxels
  double agreement = 0;  ///< median angle between directions and the solved surface, degrees
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
