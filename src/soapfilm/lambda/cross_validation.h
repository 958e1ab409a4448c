// The choice of lambda by k-fold cross-validation (suggested in section 5): the weight whose surface, found without
// some of the samples, agrees best with those. The measure is the data term itself: a held-out data term f_h gives an
// indicator u the flux <f_h, u>, what the held-out directions gain through the surface. A sample far from the surface
// gains nothing, so outliers have almost no influence; a lost part loses its samples' flux, a surface that follows the
// noise loses some everywhere.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/lambda/folds.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

/// The results of one candidate of the cross-validation. A fold's error is the part of the held-out flux that the
/// candidate misses, compared with the fold's own best candidate, in [0, 1]: so folds that are harder for all
/// candidates do not distort the mean. An empty (or opposing) result misses all.
struct CrossValidationPoint {
  double lambda_per_density = 0;  ///< lambda per sample and voxel^2
  double lambda = 0;              ///< the same on the finest grid
  double error = 0;               ///< mean over the folds
  double standard_error = 0;      ///< of that mean
  int empty_folds = 0;            ///< where no surface paid for its area
};

struct CrossValidationReport {
  int folds = 0;
  bool whole_scans = false;
  Vec3i grid;                               ///< reported vertices of the coarse grid
  double voxel = 0;                         ///< its edge of a cell, input units
  double indifference = 0;                  ///< as given
  std::vector<CrossValidationPoint> curve;  ///< by increasing lambda
  double best = 0;                          ///< lambda per sample and voxel^2 with the least error
  double chosen = 0;                        ///< by the one-standard-error rule: EnergyParams::lambda_per_density
};

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const CrossValidationParams& params);

/// The curve of candidates, given the flux of candidate c through the held-out samples of fold k: flux[c][k]. `lambda`
/// stays 0. All folds have the same candidates; at least two folds.
std::vector<CrossValidationPoint> error_curve(std::span<const double> candidates,
                                              const std::vector<std::vector<double>>& flux);

/// Index of the least error; of several, the largest lambda.
size_t least_error(const std::vector<CrossValidationPoint>& curve);
/// The one-standard-error rule (Breiman et al. 1984): index of the largest lambda whose error is at most the least one
/// plus its standard error, or plus `indifference` where that is more.
size_t one_standard_error(const std::vector<CrossValidationPoint>& curve, double indifference);

/// Chooses lambda per sample and voxel^2 for the cloud, to be used on the `finest` lattice. Every candidate is solved
/// without each fold on a grid of at most max_resolution vertices along its longest axis, never finer than `finest`;
/// lambda there is proportional to the density of the training samples, so that the training energy is, on average,
/// proportional to that of all samples. `directions` is as long as the cloud. The result does not depend on the number
/// of threads.
///
/// Throws ParameterError as validate() and make_folds() do, and when no candidate keeps a surface in any fold.
CrossValidationReport choose_lambda(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& finest,
                                    const CrossValidationParams& params, const PrimalDualParams& solver,
                                    const Context& context);

}  // namespace soapfilm
