#include "tools/mesh/signed_distance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh/triangle_normal.h"

namespace soapfilm {

namespace {

using EdgeNormal = std::pair<std::array<uint32_t, 2>, Vec3d>;

std::array<uint32_t, 2> edge_key(uint32_t a, uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// For each vertex the lowest one at its place.
std::vector<uint32_t> welded(const std::vector<Vec3d>& vertices) {
  std::vector<uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto place = [&](uint32_t i) { return std::array{vertices[i].x, vertices[i].y, vertices[i].z}; };
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return place(a) != place(b) ? place(a) < place(b) : a < b; });
  for (size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && vertices[order[i]] == vertices[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

double angle_between(Vec3d a, Vec3d b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

}  // namespace

SignedDistance::SignedDistance(const Mesh& mesh, const Context& context)
    : query_(mesh, context), vertices_(mesh.vertices), triangles_(mesh.triangles), corners_(mesh.vertices.size()) {
  const std::vector<uint32_t> first = welded(vertices_);
  for (uint32_t i = 0; i < triangles_.size(); ++i) {
    const Vec3d normal = triangle_normal(mesh, i);
    faces_.push_back(normal);
    Triangle& t = triangles_[i];
    for (uint32_t& v : t) v = first[v];
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      corners_[a] += normal * angle_between(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]);
      edges_.emplace_back(edge_key(a, b), normal);
    }
  }
  std::stable_sort(edges_.begin(), edges_.end(),
                   [](const EdgeNormal& a, const EdgeNormal& b) { return a.first < b.first; });
  size_t kept = 0;
  for (size_t i = 0; i < edges_.size(); ++i) {
    if (kept > 0 && edges_[kept - 1].first == edges_[i].first)
      edges_[kept - 1].second += edges_[i].second;
    else
      edges_[kept++] = edges_[i];
  }
  edges_.resize(kept);
}

/// Of the face, edge or vertex that the closest point lies on.
Vec3d SignedDistance::normal_at(const ClosestPoint& at) const {
  const Triangle& t = triangles_[at.triangle];
  const std::array<Vec3d, 3> p{vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  double longest = 0;
  for (size_t k = 0; k < 3; ++k) longest = std::max(longest, norm(p[(k + 1) % 3] - p[k]));
  const double near = 1e-9 * longest;
  for (size_t k = 0; k < 3; ++k)
    if (norm(at.position - p[k]) <= near) return corners_[t[k]];
  for (size_t k = 0; k < 3; ++k) {
    const Vec3d along = p[(k + 1) % 3] - p[k];
    if (norm(cross(along, at.position - p[k])) > near * norm(along)) continue;
    const auto key = edge_key(t[k], t[(k + 1) % 3]);
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), key,
                                        [](const EdgeNormal& e, const auto& wanted) { return e.first < wanted; });
    return found->second;
  }
  return faces_[at.triangle];
}

std::vector<SignedPoint> SignedDistance::operator()(const std::vector<Vec3d>& points, const Context& context) const {
  constexpr size_t per_task = 4096;
  const std::vector<ClosestPoint> closest = query_(points, context);
  std::vector<SignedPoint> out(points.size());
  parallel_for(context, points.size(), per_task, [&](size_t i) {
    const Vec3d away = points[i] - closest[i].position, normal = normal_at(closest[i]);
    const double sign = dot(away, normal) < 0 ? -1 : 1;
    // So near that rounding chose the direction, the surface's own normal is better.
    const bool on_surface = closest[i].distance <= 1e-12 * norm(points[i]);
    out[i] = {closest[i].position, on_surface ? normalized(normal) : normalized(away) * sign,
              sign * closest[i].distance};
  });
  return out;
}

}  // namespace soapfilm
