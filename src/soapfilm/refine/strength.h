// How much to smooth, and whether directions are normals: decided by samples that were held out.
#pragma once

#include <optional>

#include "soapfilm/refine/robust_fit.h"

namespace soapfilm {

struct StrengthParams {
  std::optional<double> smoothing;  ///< gamma; without it: chosen
  std::optional<double> normals;    ///< weight of directions; without it: chosen
  size_t samples = 20000;           ///< look at patches with about this many
  uint64_t seed = 1;                ///< of the choice of patches and of the samples held out
};

struct StrengthReport {
  double agreement_deg = 0;   ///< median angle between the directions and the fitted surface's normals
  double held_out_error = 0;  ///< mean distance of held-out samples, voxels
  size_t samples = 0;         ///< that were looked at
  int candidates = 0;
};

/// Fits patches of the surface to three quarters of their samples and measures the others' mean distance |phi|. gamma
/// is doubled (four times in the first search) ... see strength.cpp.
Strength choose_strength(const NarrowBand& band, const RowArray& phi0, const GridSamples& samples,
                         const RobustParams& robust, const StrengthParams& params, const Parallel& parallel,
                         StrengthReport& report);

}  // namespace soapfilm
