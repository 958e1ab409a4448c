#include "tools/mesh/distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/triangle_normal.h"
#include "tools/mesh/embree_scene.h"

namespace soapfilm {

namespace {

constexpr size_t points_per_task = 1024;
constexpr double infinity = std::numeric_limits<double>::infinity();

using Corners = std::array<Vec3d, 3>;

float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float round_up(double x) { return -round_down(-x); }

Vec3d closest_on_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d ab = b - a;
  const double length2 = dot(ab, ab);
  const double t = length2 > 0 ? std::clamp(dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
  return a + ab * t;
}

Vec3d closest_on_triangle(Vec3d p, const Corners& t) {
  const Vec3d ab = t[1] - t[0];
  const Vec3d bc = t[2] - t[1];
  const Vec3d ca = t[0] - t[2];
  const Vec3d n = cross(ab, -ca);
  const double n2 = dot(n, n);
  const double longest2 = std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)});
  const bool above_inside =
      dot(cross(ab, p - t[0]), n) >= 0 && dot(cross(bc, p - t[1]), n) >= 0 && dot(cross(ca, p - t[2]), n) >= 0;
  // A triangle without area is measured by its sides alone.
  if (above_inside && n2 > flat_height * flat_height * longest2 * longest2) return p - n * (dot(p - t[0], n) / n2);

  Vec3d best = closest_on_segment(p, t[0], t[1]);
  for (int k = 1; k < 3; ++k) {
    const Vec3d q = closest_on_segment(p, t[k], t[(k + 1) % 3]);
    if (norm(p - q) < norm(p - best)) best = q;
  }
  return best;
}

}  // namespace

struct ClosestPointQuery::Impl {
  Vec3d center;
  double to_unit = 1;              // scale under which the tree spans [-1, 1]: no float overflows
  std::vector<Corners> triangles;  // relative to the center
  EmbreeScene scene;

  struct Search {
    const Impl* impl;
    Vec3d point;
    ClosestPoint best;
  };

  /// Radius of the search in float that certainly reaches everything within `distance` of `point`: the point is rounded
  /// to float, and so is Embree's own arithmetic on it.
  float reach(double distance, Vec3d point) const {
    const double magnitude = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)}) * to_unit;
    return round_up(distance * to_unit * (1 + 1e-6) + std::max(magnitude, 1.0) * 1e-6);
  }

  static void bounds(const RTCBoundsFunctionArguments* args) {
    const Impl& self = *static_cast<const Impl*>(args->geometryUserPtr);
    Box3d box;
    for (const Vec3d& corner : self.triangles[args->primID]) box.extend(corner * self.to_unit);
    *args->bounds_o = {round_down(box.lo.x), round_down(box.lo.y), round_down(box.lo.z), 0,
                       round_up(box.hi.x),   round_up(box.hi.y),   round_up(box.hi.z),   0};
  }

  static bool visit(RTCPointQueryFunctionArguments* args) {
    auto& search = *static_cast<Search*>(args->userPtr);
    const Vec3d q = closest_on_triangle(search.point, search.impl->triangles[args->primID]);
    const double distance = norm(search.point - q);
    const bool is_tie = distance == search.best.distance && args->primID < search.best.triangle;
    if (distance > search.best.distance || (distance == search.best.distance && !is_tie)) return false;
    search.best = {q, args->primID, distance};
    const float radius = search.impl->reach(distance, search.point);
    if (radius >= args->query->radius) return false;
    args->query->radius = radius;
    return true;
  }

  void build(const Context& context) {
    const RTCGeometry geometry = rtcNewGeometry(scene.device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(triangles.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcSetGeometryPointQueryFunction(geometry, visit);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    scene.commit(context);
  }

  /// `point` and the result are relative to the center; triangles farther than `limit` need not be examined.
  ClosestPoint search(Vec3d point, double limit) const {
    Search search{this, point, {{}, std::numeric_limits<uint32_t>::max(), infinity}};
    RTCPointQuery query{};
    query.x = static_cast<float>(point.x * to_unit);
    query.y = static_cast<float>(point.y * to_unit);
    query.z = static_cast<float>(point.z * to_unit);
    query.radius = reach(limit, point);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene.get(), &query, &context, nullptr, &search);
    return search.best;
  }
};

ClosestPointQuery::ClosestPointQuery(const Mesh& mesh, const Context& context) : impl_(std::make_unique<Impl>()) {
  if (mesh.triangles.empty()) throw ParameterError("the mesh has 0 triangles, distances to it need at least 1");
  Box3d box;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3d& v = mesh.vertices[i];
    if (!is_finite(v)) throw ParameterError(fmt::format("vertex {} is ({}, {}, {}), must be finite", i, v.x, v.y, v.z));
    box.extend(v);
  }
  if (box.longest() > longest_side)
    throw ParameterError(
        fmt::format("the longest side of the mesh's box = {:g}, must be <= {:g}", box.longest(), longest_side));
  impl_->center = box.center();
  if (box.longest() > 0) impl_->to_unit = 2 / box.longest();
  impl_->triangles.resize(mesh.triangles.size());
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t v = mesh.triangles[i][k];
      if (v >= mesh.vertices.size()) {
        throw ParameterError(fmt::format("triangle {} names vertex {}, must be < {}", i, v, mesh.vertices.size()));
      }
      impl_->triangles[i][k] = mesh.vertices[v] - impl_->center;
    }
  }
  impl_->build(context);
}

ClosestPointQuery::~ClosestPointQuery() = default;
ClosestPointQuery::ClosestPointQuery(ClosestPointQuery&&) noexcept = default;
ClosestPointQuery& ClosestPointQuery::operator=(ClosestPointQuery&&) noexcept = default;

ClosestPoint ClosestPointQuery::operator()(Vec3d point) const {
  ClosestPoint found = impl_->search(point - impl_->center, infinity);
  found.position += impl_->center;
  return found;
}

std::vector<ClosestPoint> ClosestPointQuery::operator()(const std::vector<Vec3d>& points,
                                                        const Context& context) const {
  std::vector<ClosestPoint> found(points.size());
  parallel_chunks(context, points.size(), points_per_task, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (!is_finite(points[i])) throw ParameterError(fmt::format("point {} is not finite", i));
      // The triangle closest to the previous point is no farther than this.
      const double limit = i == begin ? infinity : found[i - 1].distance + norm(points[i] - points[i - 1]);
      found[i] = impl_->search(points[i] - impl_->center, limit);
    }
    for (size_t i = begin; i < end; ++i) found[i].position += impl_->center;
  });
  return found;
}

std::vector<double> distances_to_mesh(const std::vector<Vec3d>& points, const Mesh& mesh, const Context& context) {
  const auto found = ClosestPointQuery(mesh, context)(points, context);
  std::vector<double> distances(found.size());
  std::transform(found.begin(), found.end(), distances.begin(), [](const ClosestPoint& c) { return c.distance; });
  return distances;
}

DistanceSummary summarize(std::vector<double> distances) {
  DistanceSummary out;
  out.count = distances.size();
  if (distances.empty()) return out;
  std::sort(distances.begin(), distances.end());  // small ones first: most accurate sums
  double sum = 0;
  double squares = 0;
  for (const double d : distances) {
    sum += d;
    squares += d * d;
  }
  const auto n = static_cast<double>(distances.size());
  const auto percentile = [&](double p) {
    return distances[static_cast<size_t>(std::max(1.0, std::ceil(p / 100 * n))) - 1];
  };
  out.mean = sum / n;
  out.rms = std::sqrt(squares / n);
  out.maximum = distances.back();
  out.percentile95 = percentile(95);
  out.percentile99 = percentile(99);
  return out;
}

DistanceSummary point_to_mesh_distance(const std::vector<Vec3d>& points, const Mesh& mesh, const Context& context) {
  return summarize(distances_to_mesh(points, mesh, context));
}

}  // namespace soapfilm
