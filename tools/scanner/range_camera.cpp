#include "tools/scanner/range_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

using std::numbers::pi;

/// Half the extent of the box in a view's image, in input units at the target.
struct HalfExtent {
  double across = 0;
  double up = 0;
};

HalfExtent half_extent(const Pose& pose, const Box3d& box, const Vec3d& target, Rays rays) {
  HalfExtent extent;
  const double range = norm(target - pose.origin);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p = pose.to_local(
        {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y, corner & 4 ? box.hi.z : box.lo.z});
    // A corner beside or behind a central scanner would need an image of 180 degrees; it sees 2 x 80 degrees.
    const double depth = std::max(-p.z, std::tan(10.0 * radians) * std::hypot(p.x, p.y));
    const double scale = rays == Rays::central ? range / std::max(depth, 1e-12 * range) : 1.0;
    extent.across = std::max(extent.across, std::abs(p.x) * scale);
    extent.up = std::max(extent.up, std::abs(p.y) * scale);
  }
  return extent;
}

/// A scanner that rotates about the upright axis has +y, or a target, in the middle of its image.
std::vector<RangeCamera> place_spinning(const Box3d& box, const ScannerParams& params) {
  std::vector<double> elevations = params.rings_deg;
  if (elevations.empty())
    for (int row = 0; row < params.rows; ++row)
      elevations.push_back(params.rows == 1 ? 0.5 * (params.lowest_deg + params.highest_deg)
                                            : params.highest_deg -
                                                  (params.highest_deg - params.lowest_deg) * row / (params.rows - 1));
  for (double& e : elevations) e *= radians;
  const auto rows = static_cast<int>(elevations.size());
  std::vector<RangeCamera> cameras;
  uint64_t scan = 0;
  for (const Vec3d& position : scanner_positions(box, params)) {
    Vec3d heading = params.target ? *params.target - position : Vec3d{0, 1, 0};
    heading.z = 0.0;
    if (!(norm(heading) > 0.0))
      throw ParameterError("position: a spinning scanner's target must not lie straight above or below it");
    const double turn = Random(Random(params.seed).next() + scan++).uniform();
    cameras.push_back({look_at(position, position + heading), Rays::spinning, 1.0, 2.0 * pi / params.columns,
                       params.columns, rows, turn, elevations});
  }
  return cameras;
}

/// Each image as large as the box needs at the step of `params`.
void size_images(std::vector<RangeCamera>& cameras, const std::vector<HalfExtent>& extents, double step) {
  for (size_t k = 0; k < cameras.size(); ++k) {
    const double columns = std::ceil(2.0 * extents[k].across / step) + 1.0;
    const double rows = std::ceil(2.0 * extents[k].up / step) + 1.0;
    if (columns * rows > 1e8)
      throw ParameterError(
          fmt::format("step = {}, must be larger: a range image would have {} x {} rays, at most "
                      "1e8 are allowed",
                      step, columns, rows));
    cameras[k].columns = static_cast<int>(columns);
    cameras[k].rows = static_cast<int>(rows);
  }
}

}  // namespace

RangeCamera::Ray RangeCamera::ray(double column, double row) const {
  if (rays == Rays::spinning) {
    const double azimuth = (column + turn - 0.5 * columns) * step;  // to the right of the heading
    const auto below = std::min(static_cast<size_t>(row), elevations.size() - 1);
    const double part = row - static_cast<double>(below);
    const double next = elevations[std::min(below + 1, elevations.size() - 1)];
    const double elevation = elevations[below] + part * (next - elevations[below]);
    const double level = std::cos(elevation);
    return {pose.origin, pose.rotate({level * std::sin(azimuth), std::sin(elevation), -level * std::cos(azimuth)})};
  }
  const double across = (column - 0.5 * (columns - 1)) * step;
  const double up = (0.5 * (rows - 1) - row) * step;
  if (rays == Rays::parallel) return {pose.to_world({across, up, 0.0}), -pose.z};
  return {pose.origin, pose.rotate(normalized(Vec3d{across, up, -range}))};
}

double RangeCamera::spacing(double along) const {
  return rays == Rays::parallel ? step : rays == Rays::spinning ? step * along : step * along / range;
}

std::vector<RangeCamera> place_cameras(const Box3d& box, const ScannerParams& params) {
  if (params.rays == Rays::spinning) return place_spinning(box, params);
  const Vec3d target = params.target.value_or(box.center());
  std::vector<RangeCamera> cameras;
  std::vector<HalfExtent> extents;
  for (const Vec3d& position : scanner_positions(box, params)) {
    const double range = norm(position - target);
    if (!(range > 0.0)) throw ParameterError("position: must differ from the target that the view looks at");
    RangeCamera camera{look_at(position, target), params.rays, range, params.step, params.columns, params.rows};
    extents.push_back(half_extent(camera.pose, box, target, params.rays));
    cameras.push_back(camera);
  }
  if (params.step > 0.0) {
    size_images(cameras, extents, params.step);
    return cameras;
  }
  // One step for all views, so that the sampling is even; box corners fall on the middle of border pixels or within.
  double step = 0.0;
  for (const HalfExtent& extent : extents)
    step = std::max(
        {step, 2.0 * extent.across / std::max(params.columns - 1, 1), 2.0 * extent.up / std::max(params.rows - 1, 1)});
  for (RangeCamera& camera : cameras) camera.step = step;
  return cameras;
}

}  // namespace soapfilm
