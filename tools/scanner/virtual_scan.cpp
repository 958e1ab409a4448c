#include "tools/scanner/virtual_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "tools/scanner/range_camera.h"

namespace soapfilm {

namespace {

using std::numbers::pi;

void check(const ScannerParams& params) {
  const auto require = [](bool holds, const char* name, double value, const char* constraint) {
    if (!holds) throw ParameterError(fmt::format("{} = {}, must be {}", name, value, constraint));
  };
  const auto finite_from_zero = [&](const char* name, double value) {
    require(value >= 0.0 && std::isfinite(value), name, value, ">= 0");
  };
  require(params.views >= 1 && params.views <= 10000, "views", params.views, "in [1, 10000]");
  for (const double e : params.elevations_deg) require(e >= -90.0 && e <= 90.0, "elevation", e, "in [-90, 90] degrees");
  if (params.orbit == Orbit::ring && params.elevations_deg.empty())
    throw ParameterError("elevations: none given, a ring needs at least one");
  require(params.distance > 0.5 && params.distance <= 1000.0, "distance", params.distance,
          "in (0.5, 1000] diagonals of the box");
  for (const Vec3d& p : params.positions)
    if (!is_finite(p)) throw ParameterError("position: its coordinates must be finite");
  if (params.target && !is_finite(*params.target)) throw ParameterError("target: its coordinates must be finite");
  require(params.columns >= 1 && params.columns <= 20000, "columns", params.columns, "in [1, 20000]");
  require(params.rows >= 1 && params.rows <= 20000, "rows", params.rows, "in [1, 20000]");
  finite_from_zero("step", params.step);
  finite_from_zero("noise", params.noise);
  require(params.outliers >= 0.0 && params.outliers <= 1.0, "outliers", params.outliers, "in [0, 1]");
  require(params.drop_out >= 0.0 && params.drop_out < 1.0, "drop_out", params.drop_out, "in [0, 1)");
  require(params.max_incidence_deg > 0.0 && params.max_incidence_deg <= 90.0, "max_incidence_deg",
          params.max_incidence_deg, "in (0, 90]");
  for (const double e : params.rings_deg) require(e >= -90.0 && e <= 90.0, "ring", e, "in [-90, 90] degrees");
  require(params.lowest_deg >= -90.0 && params.lowest_deg <= params.highest_deg, "lowest_deg", params.lowest_deg,
          "in [-90, highest_deg]");
  require(params.highest_deg <= 90.0, "highest_deg", params.highest_deg, "<= 90");
  finite_from_zero("max_range", params.max_range);
  require(params.ghosts >= 0.0 && params.ghosts <= 1.0, "ghosts", params.ghosts, "in [0, 1]");
  finite_from_zero("ghost_lo", params.ghost_lo);
  require(params.ghost_hi >= params.ghost_lo && std::isfinite(params.ghost_hi), "ghost_hi", params.ghost_hi,
          ">= ghost_lo");
  require(params.mixed_pixels >= 0.0 && params.mixed_pixels <= 1.0, "mixed_pixels", params.mixed_pixels, "in [0, 1]");
  finite_from_zero("misalignment_deg", params.misalignment_deg);
  finite_from_zero("misalignment", params.misalignment);
}

enum class Pixel : uint8_t { empty, on_surface, outlier_on_ray, outlier_in_box };  // a ghost is one on its ray

struct Measurement {
  Pixel kind = Pixel::empty;
  Vec3d position;
  Vec3f normal;
};

/// Separate random numbers for each pixel of each scan, whatever the order in which they are computed.
Random pixel_random(uint64_t seed, size_t scan, size_t pixel) {
  Random of_seed(seed);
  Random of_scan(of_seed.next() + scan);
  return Random(of_scan.next() + pixel);
}

/// Range of a pixel at a step in depth: somewhere between the two sides. A step: half a pixel away, the range differs
/// by more than 10 times the spacing of rays, as on a plane at 84 degrees.
std::optional<double> range_at_edge(const Surface& surface, const RangeCamera& camera, int column, int row,
                                    double range, double blend) {
  constexpr double step_over_spacing = 10.0;
  for (const auto& [right, below] : {std::pair{0.5, 0.0}, std::pair{0.0, 0.5}}) {
    const RangeCamera::Ray beside = camera.ray(column + right, row + below);
    const std::optional<SurfacePoint> other = surface.intersect(beside.origin, beside.direction);
    if (other && std::abs(other->distance - range) > step_over_spacing * camera.spacing(range))
      return range + blend * (other->distance - range);
  }
  return std::nullopt;
}

Measurement measure(const Surface& surface, const Box3d& box, const ScannerParams& params, const RangeCamera& camera,
                    int column, int row, Random random) {
  const RangeCamera::Ray ray = camera.ray(column, row);
  const std::optional<SurfacePoint> hit = surface.intersect(ray.origin, ray.direction);
  if (!hit || (params.max_range > 0.0 && hit->distance > params.max_range)) return {};
  const double cosine = std::abs(dot(hit->normal, ray.direction));
  if (cosine < std::cos(params.max_incidence_deg * radians)) return {};
  // Each effect draws its random numbers whether it is on or not, so that enabling one leaves the others as they were.
  const double lost = random.uniform();
  const double outlying = random.uniform();
  const double error = random.normal();
  const Vec3d where{random.uniform(), random.uniform(), random.uniform()};
  const double ghost = random.uniform(), depth = random.uniform(params.ghost_lo, params.ghost_hi);
  const double mixed = random.uniform(), blend = random.uniform();
  if (lost < params.drop_out) return {};
  if (outlying < params.outliers) {
    const Box3d wide = outlier_box(box);
    const Vec3d size = wide.size();
    if (params.outlier_kind == Outliers::box)
      return {Pixel::outlier_in_box, wide.lo + Vec3d{size.x * where.x, size.y * where.y, size.z * where.z}, {}};
    const double middle = dot(wide.center() - ray.origin, ray.direction);
    const double near = std::max(middle - 0.5 * wide.diagonal(), 1e-3 * wide.diagonal());
    const double far = middle + 0.5 * wide.diagonal();
    return {Pixel::outlier_on_ray, ray.origin + ray.direction * (near + (far - near) * where.x), {}};
  }
  if (ghost < params.ghosts)
    return {Pixel::outlier_on_ray, hit->position + ray.direction * (depth / std::max(cosine, 1e-3)), {}};
  if (mixed < params.mixed_pixels)
    if (const auto range = range_at_edge(surface, camera, column, row, hit->distance, blend))
      return {Pixel::outlier_on_ray, ray.origin + ray.direction * *range, {}};
  return {Pixel::on_surface, hit->position + ray.direction * (params.noise * error), static_cast<Vec3f>(hit->normal)};
}

/// Rotation by |w| radians about w (Rodrigues).
Vec3d rotated(Vec3d v, Vec3d w) {
  const double angle = norm(w);
  if (angle == 0.0) return v;
  const Vec3d axis = w / angle;
  return v * std::cos(angle) + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1.0 - std::cos(angle)));
}

/// The rigid error of registration: about the mean of the scan's samples.
void misalign(std::vector<Vec3d>& positions, std::vector<Vec3f>& normals, Pose& pose, const ScannerParams& params,
              Random random) {
  if (params.misalignment == 0.0 && params.misalignment_deg == 0.0) return;
  const auto gaussian = [&](double sigma) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Vec3d{x, y, z} * sigma;
  };
  // A rotation vector with this deviation along each axis has a root mean square angle of misalignment_deg.
  const Vec3d turn = gaussian(params.misalignment_deg * radians / std::sqrt(3.0));
  const Vec3d shift = gaussian(params.misalignment);
  Vec3d center;
  for (const Vec3d& p : positions) center += (p - pose.origin) / static_cast<double>(positions.size());
  center += pose.origin;
  const auto move = [&](Vec3d p) { return center + rotated(p - center, turn) + shift; };
  for (Vec3d& p : positions) p = move(p);
  for (Vec3f& n : normals) n = static_cast<Vec3f>(rotated(static_cast<Vec3d>(n), turn));
  pose = {rotated(pose.x, turn), rotated(pose.y, turn), rotated(pose.z, turn), move(pose.origin)};
}

/// One view as a cloud of one scan; its pose moves with the misalignment.
PointCloud scan_view(const Surface& surface, const ScannerParams& params, RangeCamera& camera, size_t index,
                     const Context& context) {
  const size_t pixels = static_cast<size_t>(camera.columns) * camera.rows;
  std::vector<Measurement> image(pixels);
  const Box3d box = surface.box();
  parallel_for(context, pixels, 256, [&](size_t i) {
    const auto column = static_cast<int>(i % camera.columns);
    const auto row = static_cast<int>(i / camera.columns);
    image[i] = measure(surface, box, params, camera, column, row, pixel_random(params.seed, index, i));
  });

  PointCloud cloud;
  RangeGrid grid{camera.columns, camera.rows, std::vector<int32_t>(pixels, -1)};
  for (size_t i = 0; i < pixels; ++i) {
    if (image[i].kind == Pixel::empty) continue;
    if (image[i].kind != Pixel::outlier_in_box) grid.sample[i] = static_cast<int32_t>(cloud.size());
    cloud.positions.push_back(image[i].position);
    if (params.normals) cloud.normals.push_back(image[i].normal);
  }
  if (cloud.size() == 0) return cloud;
  misalign(cloud.positions, cloud.normals, camera.pose, params, pixel_random(params.seed, index, pixels));
  Scan scan{fmt::format("scan_{:03}", index), 0, cloud.size(), {}, {}, std::move(grid)};
  if (params.rays != Rays::parallel) {
    scan.sensor = camera.pose.origin;
  } else {
    scan.view_direction = camera.pose.z;
  }
  cloud.scans.push_back(std::move(scan));
  return cloud;
}

}  // namespace

Box3d outlier_box(const Box3d& box) {
  const double margin = 0.25 * box.diagonal();
  return {box.lo - Vec3d{margin, margin, margin}, box.hi + Vec3d{margin, margin, margin}};
}

std::vector<Vec3d> scanner_positions(const Box3d& box, const ScannerParams& params) {
  check(params);
  if (!params.positions.empty()) return params.positions;
  const Vec3d target = params.target.value_or(box.center());
  const double radius = params.distance * box.diagonal();
  const auto at = [&](double height, double angle) {
    const double axial = std::sqrt(std::max(0.0, 1.0 - height * height));
    return target + Vec3d{axial * std::cos(angle), axial * std::sin(angle), height} * radius;
  };
  std::vector<Vec3d> positions;
  if (params.orbit == Orbit::fibonacci) {
    // Equal areas along z, the golden angle around it (Gonzalez 2010).
    const double golden = pi * (3.0 - std::sqrt(5.0));
    for (int k = 0; k < params.views; ++k) positions.push_back(at(1.0 - (2.0 * k + 1.0) / params.views, golden * k));
    return positions;
  }
  for (const double elevation : params.elevations_deg)
    for (int k = 0; k < params.views; ++k)
      positions.push_back(at(std::sin(elevation * radians), 2.0 * pi * k / params.views));
  return positions;
}

ScanSet virtual_scan(const Surface& surface, const ScannerParams& params, const Context& context) {
  check(params);
  ScanSet set;
  std::vector<RangeCamera> cameras = place_cameras(surface.box(), params);
  for (size_t k = 0; k < cameras.size(); ++k) {
    context.check();
    PointCloud cloud = scan_view(surface, params, cameras[k], k, context);
    context.progress().advance(static_cast<double>(k + 1) / static_cast<double>(cameras.size()),
                               fmt::format("view {} of {}", k + 1, cameras.size()));
    if (cloud.size() == 0) continue;
    set.cloud.append(std::move(cloud));
    set.poses.push_back(cameras[k].pose);
  }
  if (set.cloud.size() == 0)
    throw ParameterError(fmt::format("views: no ray of {} range images met the surface; move the scanner or its target",
                                     cameras.size()));
  return set;
}

}  // namespace soapfilm
