// Parts of a surface that were sampled far more thinly than the rest. The default weight of area follows the mean
// density of the samples; where there are fewer than a tenth of it, a film costs more than it gains and vanishes. A
// probe finds such parts on a coarse grid: what half of the samples determine under a much lower weight and lose under
// the usual one. Whether that is surface or what outliers make of themselves, the other half tells: through surface
// their flux <f, u> is as large as the first half's, through bubbles around outliers it is zero on the mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/core/progress.h"
#include "soapfilm/field/sampling.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

struct ThinPartsParams {
  bool keep = true;            ///< look for thinly sampled parts, and weigh their samples up
  int max_resolution = 64;     ///< vertices of the probe's grid along its longest axis; in [32, 512]
  double lambda_ratio = 0.05;  ///< the probe's low lambda over the usual one, in (0, 1)
  double thinness = 4;         ///< thin: less than one sample for so many at the mean density, >= 1
  double agreement = 0.5;      ///< held-out flux of a part over the other half's, at least; in (0, 1)
  double least_samples = 12;   ///< held-out samples, net of those that disagree, that a part must have; > 0
  double most_weight = 50;     ///< of a sample, >= 1
  uint64_t seed = 1;           ///< deals the samples
};

struct ThinPart {
  double samples = 0;    ///< by what they gain on it: net of those that disagree
  double density = 0;    ///< of them per area, over the mean density of the cloud
  double agreement = 0;  ///< held-out flux over the other half's, per sample of each half
};

struct ThinPartsReport {
  Vec3i grid;                   ///< reported vertices of the probe's grid
  double voxel = 0;             ///< its edge of a cell, input units
  std::vector<ThinPart> parts;  ///< those that were found thin; empty: the usual lambda loses none
  size_t samples = 0;           ///< whose weight is over 1
  double mean_weight = 0;       ///< of these
};

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const ThinPartsParams& params);

/// A weight >= 1 for each sample of the cloud that makes thinly sampled parts count as much per area as the cloud does
/// on the mean; empty when none is found. `sampling` is the cloud's, `lambda_per_density` the usual weight of area per
/// sample and voxel^2; `directions` is as long as the cloud. The result does not depend on the number of threads.
std::vector<float> weigh_thin_parts(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& finest,
                                    const Sampling& sampling, double lambda_per_density, const ThinPartsParams& params,
                                    const PrimalDualParams& solver, const Parallel& parallel, Progress& progress,
                                    ThinPartsReport& report);

}  // namespace soapfilm
