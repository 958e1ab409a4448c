// The stage that chooses lambda, the weight of area against the samples.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/kernels/norm.h"
#include "soapfilm/lambda/cross_validation.h"
#include "soapfilm/params.h"

namespace soapfilm {

struct Lambda {
  double value = 0;                             ///< on the finest grid, > 0
  std::optional<CrossValidationReport> select;  ///< where it was chosen by cross-validation
  std::vector<std::string> warnings;
};

struct LambdaParams {
  const EnergyParams& energy;
  const CrossValidationParams& cross_validation;
  const PrimalDualParams& solver;
};

/// As given, by `density` (samples per voxel^2 of surface), or by cross-validation. Throws SamplesError where the
/// density is needed and unknown, and as choose_lambda() does.
Lambda choose(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& lattice, double density,
              const LambdaParams& params, const Context& context);

/// A warning, if lambda is near the value at which the minimal surface over samples of that density vanishes.
std::optional<std::string> near_empty(double lambda, double density);

}  // namespace soapfilm
