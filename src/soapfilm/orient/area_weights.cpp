#include "soapfilm/orient/area_weights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "soapfilm/core/exact_sum.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

AreaCoverage cover_area(const LocalSurface& surface, const SampleOrder& order) {
  constexpr double fewest_planes = 0.1;  // of the samples
  constexpr size_t fewest = 100;
  constexpr double quantile = 0.25;
  AreaCoverage coverage;
  if (surface.planes < fewest ||
      static_cast<double>(surface.planes) < fewest_planes * static_cast<double>(surface.area.size()))
    return coverage;
  // A part of them suffices for the quantile.
  constexpr size_t enough = 50000;
  const size_t step = surface.planes / enough + 1;
  size_t planes = 0;
  ExactSum area, listed;
  std::vector<std::pair<float, float>> spacing_and_area;
  spacing_and_area.reserve(surface.planes / step + 1);
  constexpr double scatter = 1.09;  // true spacing of even samples over their measured lower quartile
  for (size_t k = 0; k < order.size(); ++k) {
    const size_t i = order.sample(k);
    if (!surface.is_plane(i)) continue;  // an edge, an outlier: its area is unknown
    area.add(surface.area[i]);
    if (planes++ % step != 0) continue;
    spacing_and_area.emplace_back(surface.spacing[i], surface.area[i]);
    listed.add(surface.area[i]);
  }
  coverage.area = area.value();
  coverage.per_area = static_cast<double>(surface.planes) / coverage.area;
  std::sort(spacing_and_area.begin(), spacing_and_area.end());
  double below = 0;
  for (const auto& [spacing, own] : spacing_and_area) {
    coverage.spacing = scatter * spacing;
    if ((below += own) >= quantile * listed.value()) break;
  }
  return coverage;
}

std::vector<float> weigh_by_area(const LocalSurface& surface, double most, double most_alone, const Context& context) {
  const AreaCoverage& coverage = surface.coverage;
  constexpr double scatter = 1.5;
  constexpr double most_of_edges = 16;  // their area is a guess
  std::vector<float> weights(surface.area.size(), 1.0f);
  if (!(coverage.area > 0)) return weights;
  parallel_for(context, weights.size(), size_t{1} << 14, [&](size_t i) {
    const double ratio = surface.area[i] > 0 ? surface.area[i] * coverage.per_area : 1.0;
    const double weight = ratio > scatter ? ratio / scatter : ratio * scatter < 1 ? ratio * scatter : 1.0;
    if (surface.is_plane(i))
      weights[i] = static_cast<float>(std::min(weight, most));
    else
      weights[i] = static_cast<float>(
          std::clamp(weight, 1.0, surface.spacing[i] > 0 ? std::min(most, most_of_edges) : most_alone));
  });
  return weights;
}

}  // namespace soapfilm
