#include "tools/evaluate/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/triangle_normal.h"
#include "tools/mesh/sample_mesh.h"
#include "tools/mesh/self_intersection.h"
#include "tools/render/colormap.h"
#include "tools/scanner/mesh_surface.h"

namespace soapfilm {

namespace {

constexpr double truth_tolerance =
    2e-5;  // of the longest side: only to choose points, which then move onto the surface
constexpr size_t normals_per_task = 4096;

/// Points of a surface, and its normals there.
struct Places {
  std::vector<Vec3d> positions;
  std::vector<Vec3d> normals;  ///< unit; zero where a triangle has no area
};

Places places_on_mesh(const Mesh& mesh, const EvaluationOptions& options, const Context& context) {
  Places places;
  for (const MeshPoint& p : sample_mesh(mesh, options.points, options.seed, context)) {
    places.positions.push_back(p.position);
    places.normals.push_back(triangle_normal(mesh, p.triangle));
  }
  return places;
}

Places places_on_truth(const Surface& truth, const Mesh& tessellation, const EvaluationOptions& options,
                       const Context& context) {
  std::vector<Vec3d> near;
  for (const MeshPoint& p : sample_mesh(tessellation, options.points, options.seed, context))
    near.push_back(p.position);
  Places places;
  for (const SurfacePoint& p : truth.closest_points(near, context)) {
    places.positions.push_back(p.position);
    places.normals.push_back(p.normal);
  }
  return places;
}

/// The closest points on the other surface.
struct Found {
  std::vector<double> distances;
  std::vector<Vec3d> normals;  ///< as in Places
};

Found found_on_mesh(const ClosestPointQuery& query, const Mesh& mesh, const std::vector<Vec3d>& from,
                    const Context& context) {
  Found found;
  for (const ClosestPoint& c : query(from, context)) {
    found.distances.push_back(c.distance);
    found.normals.push_back(triangle_normal(mesh, c.triangle));
  }
  return found;
}

Found found_on_truth(const Surface& truth, const std::vector<Vec3d>& from, const Context& context) {
  Found found;
  for (const SurfacePoint& p : truth.closest_points(from, context)) {
    found.distances.push_back(p.distance);
    found.normals.push_back(p.normal);
  }
  return found;
}

DirectedError directed_error(const Places& from, const Found& found, const Context& context) {
  constexpr double no_angle = -1.0;
  std::vector<double> angles(from.normals.size());
  parallel_for(context, angles.size(), normals_per_task, [&](size_t i) {
    const Vec3d a = from.normals[i], b = found.normals[i];
    const bool both = a != Vec3d{} && b != Vec3d{};
    angles[i] = both ? std::atan2(norm(cross(a, b)), dot(a, b)) * (180.0 / std::numbers::pi) : no_angle;
  });
  std::erase(angles, no_angle);
  return {summarize(found.distances), summarize(std::move(angles))};
}

double share_within(const std::vector<double>& distances, double limit) {
  const auto within = std::count_if(distances.begin(), distances.end(), [limit](double d) { return d <= limit; });
  return static_cast<double>(within) / static_cast<double>(distances.size());
}

}  // namespace

void validate(const EvaluationOptions& options) {
  if (options.points < 1 || options.points > 100'000'000)
    throw ParameterError(fmt::format("points = {}, must be in [1, 1e8]", options.points));
  for (const double d : options.f_score_distances)
    if (!(d > 0.0 && std::isfinite(d))) throw ParameterError(fmt::format("f_score = {}, must be > 0 and finite", d));
}

Evaluation evaluate(const Mesh& mesh, const Surface& truth, const EvaluationOptions& options, const Context& context,
                    const std::vector<Vec3d>* samples) {
  validate(options);
  Evaluation out;
  out.topology = check_topology(mesh);
  const ClosestPointQuery mesh_query(mesh, context);
  const Mesh tessellation = truth.tessellate(truth_tolerance * truth.box().longest());
  out.truth_topology = check_topology(tessellation);

  context.progress().advance(0.2, "truth to mesh");
  const Places on_truth = places_on_truth(truth, tessellation, options, context);
  const Found from_truth = found_on_mesh(mesh_query, mesh, on_truth.positions, context);
  out.truth_to_mesh = directed_error(on_truth, from_truth, context);

  context.progress().advance(0.5, "mesh to truth");
  const Places on_mesh = places_on_mesh(mesh, options, context);
  const Found from_mesh = found_on_truth(truth, on_mesh.positions, context);
  out.mesh_to_truth = directed_error(on_mesh, from_mesh, context);

  for (const double d : options.f_score_distances)
    out.f_scores.push_back({d, share_within(from_mesh.distances, d), share_within(from_truth.distances, d)});
  if (samples) out.samples_to_mesh = summarize(found_on_mesh(mesh_query, mesh, *samples, context).distances);

  out.area = {mesh.area(), truth.area().value_or(tessellation.area())};
  if (out.topology.closed()) out.volume.mesh = mesh.volume();
  if (out.truth_topology.closed()) out.volume.truth = truth.volume().value_or(tessellation.volume());
  context.progress().advance(0.8, "self-intersections");
  out.self_intersections = count_self_intersections(mesh, context);
  return out;
}

Evaluation evaluate(const Mesh& mesh, const Mesh& truth, const EvaluationOptions& options, const Context& context) {
  return evaluate(mesh, MeshSurface(truth, context), options, context);
}

Mesh color_by_error(Mesh mesh, const Surface& truth, double top, const Context& context) {
  if (!(top > 0.0 && std::isfinite(top)))
    throw ParameterError(fmt::format("error_range = {}, must be > 0 and finite", top));
  std::erase_if(mesh.attributes, [](const Column& a) { return a.name == "distance"; });
  Column distance{"distance", {}};
  mesh.colors.clear();
  for (const SurfacePoint& p : truth.closest_points(mesh.vertices, context)) {
    distance.values.push_back(static_cast<float>(p.distance));
    mesh.colors.push_back(map_color(p.distance / top));
  }
  mesh.attributes.push_back(std::move(distance));
  return mesh;
}

}  // namespace soapfilm
