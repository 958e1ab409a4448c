#include "soapfilm/border/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/scanner_places.h"
#include "soapfilm/core/some_by_place.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

constexpr size_t most_scanners = 16, most_looked_at = 50000;
/// Directions are counted by the cells of a cube around the scanner, 11 degrees wide in the middle of its faces.
constexpr int cells_per_edge = 8;
constexpr size_t cells = 6 * cells_per_edge * cells_per_edge;
/// A cell with fewer samples than this share of the mean counts as empty: outliers lie everywhere.
constexpr double least_share = 0.02;
/// A scanner stands among the samples if at least this share of them lies beyond it, in every direction.
constexpr double least_beyond = 0.005;

size_t direction_cell(Vec3d direction) {
  const std::array<double, 3> d = {direction.x, direction.y, direction.z};
  size_t axis = 0;
  for (size_t a = 1; a < 3; ++a)
    if (std::abs(d[a]) > std::abs(d[axis])) axis = a;
  const auto across = [&](double v) {
    const int cell = static_cast<int>((v / std::abs(d[axis]) + 1) / 2 * cells_per_edge);
    return static_cast<size_t>(std::clamp(cell, 0, cells_per_edge - 1));
  };
  const size_t face = 2 * axis + (d[axis] < 0);
  return (face * cells_per_edge + across(d[(axis + 1) % 3])) * cells_per_edge + across(d[(axis + 2) % 3]);
}

/// What one scanner sees around it.
struct View {
  bool among = false;
  double covered = 0;
};

View look_from(Vec3d place, std::span<const Vec3d> samples) {
  constexpr int ways = 26;  // along axes and diagonals
  std::array<size_t, ways> beyond{};
  std::array<size_t, cells> seen{};
  size_t looked = 0;
  for (const Vec3d& sample : samples) {
    const Vec3d d = sample - place;
    if (d == Vec3d{}) continue;
    ++looked;
    ++seen[direction_cell(d)];
    size_t way = 0;
    for (int code = 0; code < ways + 1; ++code) {
      if (code == ways / 2) continue;  // not a direction
      beyond[way++] += dot(d, static_cast<Vec3d>(Vec3i{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1})) > 0;
    }
  }
  const double least = least_share * static_cast<double>(looked) / cells;
  const auto covered =
      std::count_if(seen.begin(), seen.end(), [&](size_t n) { return static_cast<double>(n) >= std::max(1.0, least); });
  const double fewest = least_beyond * static_cast<double>(looked);
  return {static_cast<double>(*std::min_element(beyond.begin(), beyond.end())) >= std::max(1.0, fewest),
          static_cast<double>(covered) / cells};
}

}  // namespace

Surroundings measure_surroundings(const PointCloud& cloud, const std::optional<Vec3d>& sensor, const Context& context) {
  const std::vector<Vec3d> places = some_scanners(cloud, sensor, most_scanners);
  if (places.empty()) return {};
  std::vector<Vec3d> samples;
  for (const uint32_t i : some_by_place(cloud.box(context), cloud.size(), most_looked_at, context,
                                        [&](size_t k) { return cloud.positions[k]; }))
    samples.push_back(cloud.positions[i]);
  std::vector<View> views(places.size());
  parallel_for(context, places.size(), 1, [&](size_t k) { views[k] = look_from(places[k], samples); });
  Surroundings around;
  around.scanners = places.size();
  for (const View& view : views) {
    if (!view.among) continue;
    ++around.among;
    around.covered += view.covered;
  }
  if (around.among > 0) around.covered /= static_cast<double>(around.among);
  return around;
}

}  // namespace soapfilm
