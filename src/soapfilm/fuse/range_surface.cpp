#include "soapfilm/fuse/range_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "soapfilm/core/median.h"
#include "soapfilm/core/portable_math.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

void check(const Scan& scan, const RangeGrid& grid) {
  const auto cells = static_cast<size_t>(std::max(grid.columns, 0)) * static_cast<size_t>(std::max(grid.rows, 0));
  if (grid.sample.size() != cells)
    throw ParameterError(fmt::format("scan \"{}\": range grid of {} cells, must be columns * rows = {}",
                                     printable(scan.name), grid.sample.size(), cells));
  for (const int32_t s : grid.sample)
    if (s >= 0 && static_cast<size_t>(s) >= scan.size())
      throw ParameterError(
          fmt::format("scan \"{}\": range grid names sample {}, must be < {}", printable(scan.name), s, scan.size()));
}

double squared(Vec3d v) { return dot(v, v); }

Vec3d area_vector(std::span<const Vec3d> p, const Triangle& t) {
  return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]) * 0.5;
}

/// Median distance of neighbors along rows or along columns, whichever is larger; 0 when there are none.
double spacing(const RangeGrid& grid, std::span<const Vec3d> p) {
  double largest = 0;
  for (const bool along_row : {true, false}) {
    const auto step = static_cast<size_t>(along_row ? 1 : grid.columns);
    std::vector<double> distances;
    for (size_t i = 0; i + step < grid.sample.size(); ++i) {
      if (along_row && (i + 1) % static_cast<size_t>(grid.columns) == 0) continue;
      const int32_t a = grid.sample[i], b = grid.sample[i + step];
      if (a >= 0 && b >= 0) distances.push_back(norm(p[static_cast<size_t>(b)] - p[static_cast<size_t>(a)]));
    }
    largest = std::max(largest, median(std::move(distances)));
  }
  return largest;
}

/// All triangles that the grid can give, all with the same orientation in it.
std::vector<Triangle> join_pixels(const RangeGrid& grid, std::span<const Vec3d> p) {
  std::vector<Triangle> triangles;
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column) {
      const size_t first = static_cast<size_t>(row) * static_cast<size_t>(grid.columns) + static_cast<size_t>(column);
      const size_t below = first + static_cast<size_t>(grid.columns);
      const int32_t ring[4] = {grid.sample[first], grid.sample[below], grid.sample[below + 1], grid.sample[first + 1]};
      const auto missing = std::count_if(std::begin(ring), std::end(ring), [](int32_t s) { return s < 0; });
      if (missing > 1) continue;
      const auto corner = [&](int k) { return static_cast<uint32_t>(ring[k & 3]); };
      if (missing == 1) {
        const auto gap = static_cast<int>(
            std::find_if(std::begin(ring), std::end(ring), [](int32_t s) { return s < 0; }) - std::begin(ring));
        triangles.push_back({corner(gap + 1), corner(gap + 2), corner(gap + 3)});
        continue;
      }
      const bool other = squared(p[corner(3)] - p[corner(1)]) < squared(p[corner(2)] - p[corner(0)]);
      const int k = other ? 1 : 0;
      triangles.push_back({corner(k), corner(k + 1), corner(k + 2)});
      triangles.push_back({corner(k), corner(k + 2), corner(k + 3)});
    }
  }
  return triangles;
}

/// Whether a grid runs clockwise, seen by the scanner: as most of its triangles do, by their area in the image.
bool clockwise(std::span<const Triangle> triangles, std::span<const Vec3d> p, const Viewpoint& view) {
  double sum = 0;
  for (const Triangle& t : triangles) sum += dot(area_vector(p, t), view.from(p[t[0]]));
  return sum < 0;
}

/// Number of samples from a sample to the border of the surface, at most `limit`: 0 for the ends of a boundary edge.
std::vector<int> steps_to_border(std::span<const Triangle> triangles, size_t samples, int limit) {
  std::vector<uint64_t> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[static_cast<size_t>(k)], t[static_cast<size_t>((k + 1) % 3)]);
      edges.push_back(uint64_t{low} << 32 | high);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<int> steps(samples, limit);
  for (size_t i = 0; i < edges.size();) {
    size_t next = i + 1;
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    if (next == i + 1) steps[edges[i] >> 32] = steps[edges[i] & 0xffffffff] = 0;
    i = next;
  }
  for (int reached = 0; reached + 1 < limit; ++reached) {
    for (const Triangle& t : triangles) {
      if (std::none_of(t.begin(), t.end(), [&](uint32_t v) { return steps[v] == reached; })) continue;
      for (const uint32_t v : t) steps[v] = std::min(steps[v], reached + 1);
    }
  }
  return steps;
}

}  // namespace

void validate(const RangeSurfaceParams& params) {
  if (!(params.max_edge > 1))
    throw ParameterError(fmt::format("max_edge = {}, must be > 1 (distances between samples)", params.max_edge));
  if (!(params.max_incidence_deg > 0 && params.max_incidence_deg < 90))
    throw ParameterError(fmt::format("max_incidence_deg = {}, must be > 0 and < 90 degrees", params.max_incidence_deg));
  if (params.taper < 0) throw ParameterError(fmt::format("taper = {}, must be >= 0 samples", params.taper));
}

Viewpoint::Viewpoint(const Scan& scan, const std::optional<Vec3d>& sensor) {
  const std::optional<Vec3d>& position = scan.sensor ? scan.sensor : sensor;
  central_ = position.has_value();
  if (!position && !scan.view_direction)
    throw ParameterError(fmt::format(
        "vrip needs range scans: scan \"{}\" has no sensor position and no viewing direction", printable(scan.name)));
  vector_ = position ? *position : normalized(*scan.view_direction);
  if (!is_finite(vector_) || (!central_ && vector_ == Vec3d{}))
    throw ParameterError(fmt::format("scan \"{}\": {} must be finite{}", printable(scan.name),
                                     central_ ? "sensor position" : "viewing direction", central_ ? "" : ", not zero"));
}

void require_range_scan(const Scan& scan, const std::optional<Vec3d>& sensor) {
  if (!scan.range_grid)
    throw ParameterError(fmt::format("vrip needs range scans: scan \"{}\" has no range grid", printable(scan.name)));
  [[maybe_unused]] const Viewpoint view(scan, sensor);
}

RangeSurface range_surface(const PointCloud& cloud, const Scan& scan, const RangeSurfaceParams& params,
                           const std::optional<Vec3d>& sensor) {
  validate(params);
  require_range_scan(scan, sensor);
  const Viewpoint view(scan, sensor);
  check(scan, *scan.range_grid);
  const std::span<const Vec3d> p = std::span(cloud.positions).subspan(scan.begin, scan.size());

  RangeSurface surface;
  surface.triangles = join_pixels(*scan.range_grid, p);
  if (clockwise(surface.triangles, p, view))
    for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  const double longest = params.max_edge * spacing(*scan.range_grid, p);
  const double least_cosine = portable_cos(params.max_incidence_deg * std::numbers::pi / 180);
  const auto bridges_step = [&](const Triangle& t) {
    const Vec3d area = area_vector(p, t);
    const double edge2 = std::max({squared(p[t[1]] - p[t[0]]), squared(p[t[2]] - p[t[1]]), squared(p[t[0]] - p[t[2]])});
    const double facing = dot(area, view.from((p[t[0]] + p[t[1]] + p[t[2]]) / 3.0));
    return !(edge2 <= longest * longest && facing > 0 && facing >= least_cosine * norm(area));
  };
  surface.dropped = std::erase_if(surface.triangles, bridges_step);

  std::vector<Vec3d> normal(scan.size());
  for (const Triangle& t : surface.triangles)
    for (const uint32_t v : t) normal[v] += area_vector(p, t);
  const std::vector<int> steps = steps_to_border(surface.triangles, scan.size(), params.taper);
  surface.weight.resize(scan.size());
  for (size_t v = 0; v < scan.size(); ++v) {
    const double own = cloud.weights.empty() ? 1 : cloud.weights[scan.begin + v];
    const double cosine = std::max(0.0, dot(normalized(normal[v]), view.from(p[v])));
    surface.weight[v] = static_cast<float>(own * cosine * (steps[v] + 1) / (params.taper + 1));
  }
  return surface;
}

}  // namespace soapfilm
