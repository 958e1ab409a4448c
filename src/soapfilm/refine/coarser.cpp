#include "soapfilm/refine/coarser.h"

#include <cmath>
#include <optional>
#include <utility>

#include "soapfilm/refine/held_out.h"
#include "soapfilm/refine/prolong_distance.h"

namespace soapfilm {

namespace {

// Held-out distances over those from the finer fit up to which a coarser one serves. With a fifth to a half of a sample
// per voxel^2 and noise of half a voxel it is nearer to the truth up to some 1.03: both surfaces start from a
// segmentation that saw the samples, and the finer one forgets that less.
constexpr double most_cost = 1.03;

}  // namespace

std::vector<Coarser> coarser_problems(const Level& level, float threshold, const GridSamples& samples, double density,
                                      double sparse, double reach, const Parallel& parallel) {
  std::vector<Coarser> found;
  Level indicator;
  for (; density < sparse; density *= 4) {
    indicator = every_second_vertex(found.empty() ? level : indicator, threshold, parallel);
    Start start = start_from(indicator, threshold, reach, parallel);
    if (start.band.rows() == 0) break;
    found.push_back(
        {std::move(start), on_every_second_vertex(found.empty() ? samples : found.back().samples, parallel)});
  }
  return found;
}

bool serves(const Coarser& coarse, const Strength& strength, const Start& finer, const GridSamples& finer_samples,
            const RobustParams& robust, const Parallel& parallel) {
  const HeldOutParams patches;
  HeldOutParams same = patches;
  same.patch_bricks *= 2;
  HeldOut on_coarse(coarse.start, coarse.samples, robust, patches, parallel);
  HeldOut on_fine(finer, finer_samples, robust, same, parallel);
  const auto of_coarse = on_fine.mean_distance(
      prolong_distance(on_coarse.band(), on_coarse.fit(strength), on_fine.band(), on_fine.phi0(), parallel));
  const auto of_fine = on_fine.mean_distance(on_fine.fit(on_half_the_voxel(strength)));
  return of_coarse && of_fine && *of_coarse <= most_cost * *of_fine;
}

bool is_near(const Start& start, const RowArray& phi, double far, const Parallel& parallel) {
  constexpr float at_surface = 1;  // voxels
  constexpr double allowed = 0.002;
  const double excess = sum_over_rows(all_rows(start.band), parallel, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin * brick_side; i < end * brick_side; ++i)
      if (const float before = start.phi0.data()[i]; before != 0 && std::abs(before) < at_surface)
        sum += (std::abs(phi.data()[i] - before) > far ? 1 : 0) - allowed;
    return sum;
  });
  return excess <= 0;
}

}  // namespace soapfilm
