// Chooses how much to smooth, and whether directions are normals, by held-out samples.
#pragma once

#include <optional>

#include "soapfilm/refine/fit/robust_fit.h"
#include "soapfilm/refine/topology/start.h"
#include "soapfilm/report.h"

namespace soapfilm {

struct FitWeightReport {
  double agreement_deg = 0;   ///< median angle between the directions and the fitted surface's normals
  double held_out_error = 0;  ///< mean distance of held-out samples, voxels
  size_t samples = 0;         ///< that were used
  int candidates = 0;
};

struct FitWeightParams {
  std::optional<double> smoothing{};  ///< gamma; without it: chosen
  std::optional<double> normals{};    ///< weight of directions; without it: chosen
};

/// Fits patches of the surface to three quarters of their samples and measures the distance of the others: the score is
/// the mean of |phi| along the first surface's normals, which a surface that folds towards its samples cannot make
/// small. gamma is searched in factors of 4 from 0.2 downhill, not below (1.4 noise)^4: features smaller than the noise
/// cannot be distinguished from it, and under strong noise the band, which lies around the thresholded surface, favors
/// surfaces that follow that one's own noise. Then it takes the smoothest surface within half a standard error of the
/// best (after Hastie, Tibshirani and Friedman 2009, section 7.10, who take one), by interpolation in log gamma, or the
/// minimum of a parabola where that is larger: few held-out samples suffice to recognize fits that are too rough.
/// Directions are tried as normals when their median angle to the fitted surface is under 40 degrees, and used, with
/// the weight found in factors of 4 (where the angle is over 20 degrees half of it, or a tenth with edge-preserving
/// reweighting), when that lowers the score or, with edge-preserving reweighting, raises it by less than one standard
/// error. The noise is 1.48 times the median of the held-out distances, the standard error that of as many normal
/// deviates. Cost: about ten fits of about 20,000 samples, whatever their total number.
FitWeights choose_fit_weights(const Start& start, const GridSamples& samples, const RobustParams& robust,
                              const FitWeightParams& params, const Context& context, FitWeightReport& report);

}  // namespace soapfilm
