// Distance of held-out samples from the fitted surface: the measure by which fit weights and grid are chosen.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "soapfilm/refine/fit/robust_fit.h"
#include "soapfilm/refine/topology/start.h"

namespace soapfilm {

struct HeldOutParams {
  size_t samples = 20000;  ///< use patches of the surface with about this many
  int patch_bricks = 4;    ///< along each axis: twice as many on a grid twice as fine give the same patches
  uint64_t seed = 1;       ///< of the choice of patches
};

/// Patches of the surface, fitted to three quarters of their samples.
class HeldOut {
 public:
  HeldOut(const Start& start, const GridSamples& samples, const RobustParams& robust, const HeldOutParams& params,
          const Context& context);
  HeldOut(const HeldOut&) = delete;  // the displacement refers to the band
  HeldOut& operator=(const HeldOut&) = delete;

  struct Outcome {
    double score = 0;           ///< mean distance of the held-out samples, voxels, each at most 3 (residuals())
    double noise = 0;           ///< standard deviation of the samples from the surface, voxels, by their median
    double standard_error = 0;  ///< of the score if the noise is normal: outliers do not enter
    double agreement_deg = 0;   ///< median angle between the directions and the surface's normals
  };

  /// Result of a fit to the other samples. Cached, so that searches may repeat it.
  const Outcome& outcome(double smoothing, double normals);
  double score(double smoothing, double normals) { return outcome(smoothing, normals).score; }
  /// No edge-preserving reweighting from now on.
  void reset_curvature_weights();

  /// phi on band(), fitted to the other samples. Each fit starts with the curvature weights of the last one: this saves
  /// rounds.
  const RowArray& fit(const FitWeights& fit_weights);
  /// Mean distance of the held-out samples from a surface on band(), voxels; nothing where no such sample is in it.
  std::optional<double> mean_distance(const RowArray& phi) const;

  const NarrowBand& band() const { return part_.first; }  ///< that of the patches
  const RowArray& phi0() const { return part_.second; }
  size_t samples() const { return samples_.size(); }
  int candidates() const { return static_cast<int>(outcomes_.size()); }

 private:
  Outcome judge(double smoothing, double normals);
  std::vector<float> residuals(const RowArray& phi) const;
  double agreement() const;

  RobustParams robust_;
  const Context& context_;
  BrickMask patches_;
  GridSamples samples_;
  std::pair<NarrowBand, RowArray> part_;
  CellSamples cells_;
  Displacement displacement_;
  std::vector<uint8_t> train_;
  bool yield_ = true;
  std::vector<std::optional<Jet>> first_;  // of phi0
  std::map<std::pair<double, double>, Outcome> outcomes_;
};

}  // namespace soapfilm
