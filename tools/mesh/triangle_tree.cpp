#include "tools/mesh/triangle_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"
#include "soapfilm/mesh/triangle_normal.h"
#include "tools/mesh/distance.h"

namespace soapfilm {

namespace {

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

TreeFrame TreeFrame::of(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw ParameterError("the mesh has 0 triangles, distances to it need at least 1");
  Box3d box;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3d& v = mesh.vertices[i];
    if (!is_finite(v)) throw ParameterError(fmt::format("vertex {} is ({}, {}, {}), must be finite", i, v.x, v.y, v.z));
    box.extend(v);
  }
  if (box.longest() > ClosestPointQuery::longest_side)
    throw ParameterError(fmt::format("the longest side of the mesh's box = {:g}, must be <= {:g}", box.longest(),
                                     ClosestPointQuery::longest_side));
  return {box.center(), box.longest() > 0 ? 2 / box.longest() : 1};
}

Vec3d TreeFrame::corner(const Mesh& mesh, size_t triangle, int k) const {
  const uint32_t v = mesh.triangles[triangle][k];
  if (v >= mesh.vertices.size())
    throw ParameterError(fmt::format("triangle {} names vertex {}, must be < {}", triangle, v, mesh.vertices.size()));
  return mesh.vertices[v] - center;
}

struct TriangleTree::Search {
  const TriangleTree* tree;
  Vec3d point;
  ClosestPoint best;
};

TriangleTree::TriangleTree(const Mesh& mesh, const TreeFrame& frame, size_t begin, size_t end, const Context& context)
    : to_unit_(frame.to_unit), first_(begin), triangles_(end - begin) {
  for (size_t i = begin; i < end; ++i)
    for (int k = 0; k < 3; ++k) triangles_[i - begin][k] = frame.corner(mesh, i, k);
  scene_.build(this, triangles_.size(), bounds, visit, context);
}

/// Radius of the search in float that certainly reaches everything within `distance` of `point`: the point is rounded
/// to float, and so is Embree's own arithmetic on it.
float TriangleTree::reach(double distance, Vec3d point) const {
  const double magnitude = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)}) * to_unit_;
  return round_up(distance * to_unit_ * (1 + 1e-6) + std::max(magnitude, 1.0) * 1e-6);
}

void TriangleTree::bounds(const RTCBoundsFunctionArguments* args) {
  const TriangleTree& self = *static_cast<const TriangleTree*>(args->geometryUserPtr);
  Box3d box;
  for (const Vec3d& corner : self.triangles_[args->primID]) box.extend(corner * self.to_unit_);
  *args->bounds_o = {round_down(box.lo.x), round_down(box.lo.y), round_down(box.lo.z), 0,
                     round_up(box.hi.x),   round_up(box.hi.y),   round_up(box.hi.z),   0};
}

bool TriangleTree::visit(RTCPointQueryFunctionArguments* args) {
  auto& search = *static_cast<Search*>(args->userPtr);
  const Vec3d q = closest_on_triangle(search.point, search.tree->triangles_[args->primID]);
  const double distance = norm(search.point - q);
  const auto triangle = static_cast<uint32_t>(search.tree->first_ + args->primID);
  const bool is_tie = distance == search.best.distance && triangle < search.best.triangle;
  if (distance > search.best.distance || (distance == search.best.distance && !is_tie)) return false;
  search.best = {q, triangle, distance};
  const float radius = search.tree->reach(distance, search.point);
  if (radius >= args->query->radius) return false;
  args->query->radius = radius;
  return true;
}

ClosestPoint TriangleTree::search(Vec3d point, double limit) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Search search{this, point, {{}, std::numeric_limits<uint32_t>::max(), infinity}};
  RTCPointQuery query{};
  query.x = static_cast<float>(point.x * to_unit_);
  query.y = static_cast<float>(point.y * to_unit_);
  query.z = static_cast<float>(point.z * to_unit_);
  query.radius = reach(limit, point);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_.get(), &query, &context, nullptr, &search);
  return search.best;
}

}  // namespace soapfilm
