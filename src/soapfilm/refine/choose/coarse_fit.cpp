#include "soapfilm/refine/choose/coarse_fit.h"

#include <cmath>

#include "soapfilm/refine/choose/held_out.h"
#include "soapfilm/refine/fit/prolong_distance.h"

namespace soapfilm {

namespace {

// Largest ratio of the held-out distances of the coarser fit to those of the finer one at which the coarser one is
// used. With 0.2 to 0.5 samples per voxel^2 and noise of half a voxel it is nearer to the truth up to about 1.03: both
// surfaces start from a segmentation that saw the held-out samples, and the finer one keeps more of that.
constexpr double most_cost = 1.03;

}  // namespace

bool suffices(const CoarseFit& coarse, const FineProblem& finer, const RobustParams& robust, const Context& context) {
  const HeldOutParams patches;
  HeldOutParams same = patches;
  same.patch_bricks *= 2;
  HeldOut on_fine(finer.start, finer.samples, robust, same, context);
  const auto of_coarse = [&] {
    HeldOut on_coarse(coarse.start, coarse.samples, robust, patches, context);
    return on_fine.mean_distance(
        prolong_distance(on_coarse.band(), on_coarse.fit(coarse.fit_weights), on_fine.band(), on_fine.phi0(), context));
  }();
  const auto of_fine = on_fine.mean_distance(on_fine.fit(finer.fit_weights));
  return of_coarse && of_fine && *of_coarse <= most_cost * *of_fine;
}

bool is_near(const Start& start, const RowArray& phi, double far, const Context& context) {
  constexpr float at_surface = 1;  // voxels
  constexpr double allowed = 0.002;
  const double excess = sum_over_rows(start.band, context, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin * brick_side; i < end * brick_side; ++i) {
      const float before = start.phi0.data()[i], now = phi.data()[i];
      if (before == 0 || std::abs(before) >= at_surface) continue;  // 0: not in the band
      sum += (now == before || std::abs(now - before) > far ? 1 : 0) - allowed;
    }
    return sum;
  });
  return excess <= 0;
}

}  // namespace soapfilm
