#include "tools/scanner/sample_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "tools/mesh/sample_mesh.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {

namespace {

constexpr size_t draws_per_task = 256;

void check(const SamplingParams& params) {
  if (params.count < 1) throw ParameterError(fmt::format("samples = {}, must be >= 1", params.count));
  if (!(params.noise >= 0.0 && std::isfinite(params.noise)))
    throw ParameterError(fmt::format("noise = {}, must be >= 0", params.noise));
  if (!(params.outliers >= 0.0 && params.outliers <= 1.0))
    throw ParameterError(fmt::format("outliers = {}, must be in [0, 1]", params.outliers));
  for (const Vec3d& p : params.sensors)
    if (!is_finite(p)) throw ParameterError("position: its coordinates must be finite");
}

/// The position with the smallest angle to the normal at a point of the surface, of those with a free line of sight if
/// there is one.
Vec3d best_sensor(const Surface& surface, const std::vector<Vec3d>& sensors, Vec3d point, Vec3d normal, double lift) {
  const Vec3d above = point + normal * lift;  // clear of the surface itself
  std::vector<std::pair<double, size_t>> order;
  for (size_t k = 0; k < sensors.size(); ++k) order.emplace_back(-dot(normalized(sensors[k] - above), normal), k);
  std::sort(order.begin(), order.end());
  for (const auto& [negative_cosine, k] : order) {
    if (negative_cosine >= 0.0) break;
    const Vec3d way = sensors[k] - above;
    const std::optional<SurfacePoint> obstacle = surface.intersect(above, normalized(way));
    if (!obstacle || obstacle->distance > norm(way)) return sensors[k];
  }
  return sensors[order.front().second];
}

Vec3d random_direction(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return normalized(Vec3d{x, y, z});
}

/// Even samples with their true normals.
PointCloud undisturbed(const Surface& surface, size_t count, uint64_t seed, const Context& context) {
  const Mesh mesh = surface.tessellate(1e-4 * surface.box().longest());
  const TrianglesByArea row(mesh);
  std::vector<Vec3d> near(count);
  Random random(seed);
  for (Vec3d& p : near) {
    const Triangle& t = mesh.triangles[row.at(random.uniform() * row.total())];
    // Uniform in a triangle: sqrt of one number, the other unchanged (Turk 1990).
    const double r = std::sqrt(random.uniform());
    const double s = random.uniform();
    p = mesh.vertices[t[0]] * (1.0 - r) + mesh.vertices[t[1]] * (r * (1.0 - s)) + mesh.vertices[t[2]] * (r * s);
  }

  PointCloud cloud;
  cloud.positions.reserve(count);
  cloud.normals.reserve(count);
  for (const SurfacePoint& p : surface.closest_points(near, context)) {
    cloud.positions.push_back(p.position);
    cloud.normals.push_back(static_cast<Vec3f>(p.normal));
  }
  cloud.scans.push_back({"samples", 0, count, {}, {}, {}});
  return cloud;
}

}  // namespace

PointCloud sample_surface(const Surface& surface, size_t count, uint64_t seed) {
  return undisturbed(surface, count, seed, Context(1));
}

PointCloud sample_surface(const Surface& surface, const SamplingParams& params, const Context& context) {
  check(params);
  PointCloud cloud = undisturbed(surface, params.count, params.seed, context);
  if (!params.sensors.empty()) cloud.sensors.resize(cloud.size());
  const Box3d wide = outlier_box(surface.box());
  const double lift = 1e-6 * surface.box().longest();
  const uint64_t first_stream = Random(params.seed).next();
  parallel_for(context, cloud.size(), draws_per_task, [&](size_t i) {
    // Separate random numbers for each sample, drawn whether they are used or not: enabling an effect leaves the others
    // as they were.
    Random random(Random(first_stream + i).next());
    const double outlying = random.uniform();
    const double error = random.normal();
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    const Vec3d direction = random_direction(random);
    const double pick = random.uniform();
    const bool outlier = outlying < params.outliers;
    const auto normal = static_cast<Vec3d>(cloud.normals[i]);
    if (!params.sensors.empty()) {
      const auto any = static_cast<size_t>(pick * static_cast<double>(params.sensors.size()));
      cloud.sensors[i] =
          outlier ? params.sensors[any] : best_sensor(surface, params.sensors, cloud.positions[i], normal, lift);
    }
    if (outlier) {
      const Vec3d size = wide.size();
      cloud.positions[i] = wide.lo + Vec3d{size.x * x, size.y * y, size.z * z};
      cloud.normals[i] = static_cast<Vec3f>(direction);
    } else {
      cloud.positions[i] += normal * (params.noise * error);
    }
  });
  if (!params.sensors.empty()) cloud.normals.clear();
  return cloud;
}

}  // namespace soapfilm
