#include "soapfilm/border/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

constexpr size_t most_scanners = 16, most_samples = 50000;
/// Directions are counted by the cells of a cube around the scanner, 11 degrees wide in the middle of its faces.
constexpr int cells_per_edge = 8;
constexpr size_t cells = 6 * cells_per_edge * cells_per_edge;
/// A cell with fewer samples than this share of the mean counts as empty: outliers lie everywhere.
constexpr double least_share = 0.02;
/// A scanner stands among the samples if at least this share of them lies beyond it, in every direction.
constexpr double least_beyond = 0.005;

/// Different places, from samples evenly spread over the cloud.
std::vector<Vec3d> places_of_scanners(const PointCloud& cloud, const std::optional<Vec3d>& sensor) {
  std::vector<Vec3d> places;
  for (size_t k = 0; k < most_scanners; ++k) {
    const size_t i = (2 * k + 1) * cloud.size() / (2 * most_scanners);
    const auto scan =
        std::find_if(cloud.scans.begin(), cloud.scans.end(), [&](const Scan& s) { return s.begin <= i && i < s.end; });
    std::optional<Vec3d> place = sensor;
    if (!cloud.sensors.empty() && is_finite(cloud.sensors[i]))
      place = cloud.sensors[i];
    else if (scan != cloud.scans.end() && scan->sensor)
      place = scan->sensor;
    if (place && std::find(places.begin(), places.end(), *place) == places.end()) places.push_back(*place);
  }
  return places;
}

size_t cell_of(Vec3d direction) {
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

View look_from(Vec3d place, const PointCloud& cloud) {
  constexpr int ways = 26;  // along axes and diagonals
  std::array<size_t, ways> beyond{};
  std::array<size_t, cells> seen{};
  size_t looked = 0;
  const size_t step = (cloud.size() + most_samples - 1) / most_samples;
  for (size_t i = 0; i < cloud.size(); i += step) {
    const Vec3d d = cloud.positions[i] - place;
    if (d == Vec3d{}) continue;
    ++looked;
    ++seen[cell_of(d)];
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
  const std::vector<Vec3d> places = places_of_scanners(cloud, sensor);
  std::vector<View> views(places.size());
  parallel_for(context, places.size(), 1, [&](size_t k) { views[k] = look_from(places[k], cloud); });
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
