#include "tools/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "tools/mesh/sample_mesh.h"
#include "tools/render/colormap.h"

namespace soapfilm {

namespace {

/// Points of an alignment are thinned to about so many.
constexpr size_t aligned_points = 30000;

std::vector<double> distances_of(const std::vector<SignedPoint>& found, double sign) {
  std::vector<double> distances;
  for (const SignedPoint& p : found) distances.push_back(sign * p.distance);
  return distances;
}

std::vector<Vec3d> positions_of(const std::vector<MeshPoint>& points) {
  std::vector<Vec3d> positions;
  for (const MeshPoint& p : points) positions.push_back(p.position);
  return positions;
}

std::vector<Vec3d> thinned(const std::vector<Vec3d>& points) {
  const size_t every = (points.size() + aligned_points - 1) / aligned_points;
  std::vector<Vec3d> some;
  for (size_t i = 0; i < points.size(); i += every) some.push_back(points[i]);
  return some;
}

/// `distances` sorted by size first, so that sums of small numbers come first.
Deviations deviations_of(std::vector<double> distances, const CompareOptions& options) {
  Deviations out;
  out.points = distances.size();
  std::sort(distances.begin(), distances.end(),
            [](double a, double b) { return std::abs(a) != std::abs(b) ? std::abs(a) < std::abs(b) : a < b; });
  const auto n = static_cast<double>(distances.size());
  double squares = 0;
  for (const double d : distances) out.mean += d, squares += d * d;
  out.mean /= n;
  out.rms = std::sqrt(squares / n);
  const auto percentile = [&](double p) {
    return std::abs(distances[static_cast<size_t>(std::max(1.0, std::ceil(p / 100 * n))) - 1]);
  };
  out.percentile95 = percentile(95), out.percentile99 = percentile(99);
  const auto [lowest, highest] = std::minmax_element(distances.begin(), distances.end());
  out.lowest = *lowest, out.highest = *highest;
  const double t = options.tolerance;
  if (t > 0) {
    const auto share = [&](auto&& counts) {
      return static_cast<double>(std::count_if(distances.begin(), distances.end(), counts)) / n;
    };
    out.above = share([t](double d) { return d > t; });
    out.below = share([t](double d) { return d < -t; });
    out.within = share([t](double d) { return std::abs(d) <= t; });
  }
  out.histogram_end = t > 0 ? 2 * t : out.percentile99 > 0 ? out.percentile99 : 1.0;
  out.histogram.resize(options.bins);
  const auto bins = static_cast<double>(options.bins);
  for (const double d : distances) {
    const double at = std::floor((d / out.histogram_end + 1) / 2 * bins);
    ++out.histogram[static_cast<size_t>(std::clamp(at, 0.0, bins - 1))];
  }
  return out;
}

void flip_inside_out(Mesh& mesh) {
  if (!check_topology(mesh).closed() || mesh.volume() >= 0) return;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

SignedDistance distance_to_model(const Mesh& model, const Context& context) {
  Mesh outward;
  outward.vertices = model.vertices;
  outward.triangles = model.triangles;
  flip_inside_out(outward);
  return {outward, context};
}

void judge(Comparison& out, const CompareOptions& options) {
  if (options.tolerance == 0) return;
  out.within_tolerance =
      out.part_to_model.within >= options.least && (!out.model_to_part || out.model_to_part->within >= options.least);
}

void move(Mesh& mesh, const RigidMotion& motion) {
  for (Vec3d& v : mesh.vertices) v = motion.point(v);
  for (Vec3f& n : mesh.normals) n = static_cast<Vec3f>(motion.vector(static_cast<Vec3d>(n)));
}

void move(PointCloud& cloud, const RigidMotion& motion) {
  for (Vec3d& p : cloud.positions) p = motion.point(p);
  for (Vec3d& p : cloud.sensors) p = motion.point(p);
  for (Vec3f& n : cloud.normals) n = static_cast<Vec3f>(motion.vector(static_cast<Vec3d>(n)));
  for (Scan& scan : cloud.scans) {
    if (scan.sensor) scan.sensor = motion.point(*scan.sensor);
    if (scan.view_direction) scan.view_direction = motion.vector(*scan.view_direction);
  }
}

/// Green around 0, yellow and red above, cyan and blue below.
Rgb8 deviation_color(double ratio) {
  constexpr Rgb8 stops[] = {{38, 70, 200}, {60, 190, 220}, {90, 190, 100}, {245, 215, 70}, {205, 40, 40}};
  if (std::isnan(ratio)) return {150, 150, 150};
  const double at = (std::clamp(ratio, -1.0, 1.0) + 1) * 2;
  const auto piece = static_cast<size_t>(std::min(at, 3.0));
  const auto share = static_cast<float>(at - static_cast<double>(piece));
  return to_srgb(to_linear(stops[piece]) * (1 - share) + to_linear(stops[piece + 1]) * share);
}

void set_deviations(const std::vector<double>& distances, double top, std::vector<Rgb8>& colors,
                    std::vector<Column>& columns) {
  if (!(top > 0 && std::isfinite(top))) throw ParameterError(fmt::format("range = {}, must be > 0 and finite", top));
  std::erase_if(columns, [](const Column& column) { return column.name == "distance"; });
  Column column{"distance", {}};
  colors.clear();
  for (const double d : distances) {
    column.values.push_back(static_cast<float>(d));
    colors.push_back(deviation_color(d / top));
  }
  columns.push_back(std::move(column));
}

}  // namespace

void validate(const CompareOptions& o) {
  const auto refuse = [](const char* name, double value, const char* constraint) {
    throw ParameterError(fmt::format("{} = {}, must be {}", name, value, constraint));
  };
  if (!(o.tolerance >= 0 && std::isfinite(o.tolerance))) refuse("tolerance", o.tolerance, ">= 0 and finite");
  if (!(o.least > 0 && o.least <= 1)) refuse("least", o.least, "in (0, 1]");
  if (o.points < 1 || o.points > 100'000'000) refuse("points", static_cast<double>(o.points), "in [1, 1e8]");
  if (o.bins < 1 || o.bins > 1000) refuse("bins", static_cast<double>(o.bins), "in [1, 1000]");
}

Comparison compare(MeshPart& part, const Mesh& model, const CompareOptions& options, const Context& context) {
  validate(options);
  flip_inside_out(part.mesh);
  const SignedDistance to_model = distance_to_model(model, context);
  std::vector<Vec3d> points = positions_of(sample_mesh(part.mesh, options.points, options.seed, context));
  Comparison out;
  if (options.align) {
    out.alignment = align(thinned(points), to_model, context);
    move(part.mesh, out.alignment->motion);
    for (Vec3d& p : points) p = out.alignment->motion.point(p);
  }
  out.part_to_model = deviations_of(distances_of(to_model(points, context), 1), options);
  part.distances = distances_of(to_model(part.mesh.vertices, context), 1);
  // A point of the model outside of the part lacks material there.
  const SignedDistance to_part(part.mesh, context);
  const std::vector<Vec3d> on_model = positions_of(sample_mesh(model, options.points, options.seed, context));
  out.model_to_part = deviations_of(distances_of(to_part(on_model, context), -1), options);
  judge(out, options);
  return out;
}

Comparison compare(ScanPart& part, const Mesh& model, const CompareOptions& options, const Context& context) {
  validate(options);
  if (part.cloud.positions.empty()) throw ParameterError("the scan has 0 samples, must have at least 1");
  const SignedDistance to_model = distance_to_model(model, context);
  Comparison out;
  if (options.align) {
    out.alignment = align(thinned(part.cloud.positions), to_model, context);
    move(part.cloud, out.alignment->motion);
  }
  part.distances = distances_of(to_model(part.cloud.positions, context), 1);
  out.part_to_model = deviations_of(part.distances, options);
  judge(out, options);
  return out;
}

Mesh color_by_deviation(const MeshPart& part, double top) {
  Mesh mesh = part.mesh;
  set_deviations(part.distances, top, mesh.colors, mesh.attributes);
  return mesh;
}

PointCloud color_by_deviation(const ScanPart& part, double top) {
  PointCloud cloud = part.cloud;
  set_deviations(part.distances, top, cloud.colors, cloud.columns);
  return cloud;
}

}  // namespace soapfilm
