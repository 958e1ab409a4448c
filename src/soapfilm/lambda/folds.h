// The samples divided into parts, each of which is held out once: training and test data of cross-validation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/params.h"

namespace soapfilm {

/// Fewer held-out samples are too few to judge a surface.
inline constexpr size_t fewest_held_out = 20;

struct Folds {
  int count = 0;
  bool whole_scans = false;
  std::vector<uint8_t> of_sample;  ///< in [0, count), one per sample of the cloud
  std::vector<size_t> sizes;       ///< usable samples of each fold: with a direction and a weight > 0
};

/// Single samples are assigned by the random sequence of `seed`; whole scans go, largest first, to the smallest fold,
/// so that folds are about equal. Depends only on the arguments. Throws ParameterError when `count` is outside [2,
/// 100], when there are fewer scans than folds, or when a fold has fewer than `fewest_held_out` usable samples.
Folds make_folds(const PointCloud& cloud, std::span<const Vec3f> directions, int count, FoldSource source,
                 uint64_t seed);

/// The data terms of a fold's two parts. f is linear in the samples: their sum is that of the whole cloud.
struct FoldFields {
  SupportField training;      ///< of all samples but the fold's
  SupportField held_out;      ///< of the fold's samples alone
  double training_share = 0;  ///< share of the usable samples that are in training, in (0, 1)
};

/// Throws ParameterError unless `fold` is in [0, folds.count).
FoldFields hold_out(const PointCloud& cloud, std::span<const Vec3f> directions, const Folds& folds, int fold,
                    const Lattice& lattice, const Context& context);

}  // namespace soapfilm
