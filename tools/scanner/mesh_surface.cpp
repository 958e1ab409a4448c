#include "tools/scanner/mesh_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/mesh/triangle_normal.h"
#include "tools/mesh/embree_scene.h"

namespace soapfilm {

namespace {

void check(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw InputError("mesh: 0 triangles, must have at least one");
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!is_finite(mesh.vertices[i])) throw InputError(fmt::format("mesh: vertex {} is not finite", i));
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t v : mesh.triangles[i])
      if (v >= mesh.vertices.size())
        throw InputError(fmt::format("mesh: triangle {} names vertex {}, must be < {}", i, v, mesh.vertices.size()));
}

/// The point of a triangle nearest to p, which is in its plane up to rounding, and in it or just beside it.
Vec3d pull_into_triangle(const Mesh& mesh, uint32_t index, Vec3d p) {
  const Triangle& t = mesh.triangles[index];
  const Vec3d a = mesh.vertices[t[0]];
  const Vec3d ab = mesh.vertices[t[1]] - a, ac = mesh.vertices[t[2]] - a, ap = p - a;
  const Vec3d n = cross(ab, ac);
  const double n2 = dot(n, n);
  if (n2 == 0.0) return p;
  double v = std::max(0.0, dot(cross(ap, ac), n) / n2);  // barycentric weights of b and c
  double w = std::max(0.0, dot(cross(ab, ap), n) / n2);
  if (v + w > 1.0) {
    const double sum = v + w;
    v /= sum;
    w /= sum;
  }
  return a + ab * v + ac * w;
}

}  // namespace

/// Embree sees the mesh in single precision, centered and scaled to about [-1, 1].
struct MeshSurface::Rays {
  EmbreeScene scene;
  Vec3d center;
  double scale;   ///< input units per unit of that frame
  double radius;  ///< of a ball around the mesh, input units

  Rays(const Mesh& mesh, const Box3d& box, const Context& context)
      : center(box.center()), scale(box.longest() > 0.0 ? 0.5 * box.longest() : 1.0), radius(0.5 * box.diagonal()) {
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(scene.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                             mesh.vertices.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle),
                                              mesh.triangles.size());
    if (!vertices || !triangles) throw std::bad_alloc();
    std::transform(mesh.vertices.begin(), mesh.vertices.end(), static_cast<Vec3f*>(vertices),
                   [&](Vec3d v) { return to_local(v); });
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<Triangle*>(triangles));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    scene.commit(context);
  }

  Vec3f to_local(Vec3d p) const { return static_cast<Vec3f>((p - center) / scale); }
};

MeshSurface::MeshSurface(Mesh mesh, const Context& context, Faces faces) : mesh_(std::move(mesh)) {
  check(mesh_);
  for (const Triangle& t : mesh_.triangles)  // unused vertices are no part of the surface
    for (const uint32_t v : t) box_.extend(mesh_.vertices[v]);
  closed_ = check_topology(mesh_).closed();
  turned_ = faces == Faces::outward && closed_ && mesh_.volume() < 0.0;
  if (turned_) {
    for (Triangle& t : mesh_.triangles) std::swap(t[1], t[2]);
    for (Vec3f& n : mesh_.normals) n = -n;
  }
  rays_ = std::make_unique<Rays>(mesh_, box_, context);
  closest_point_ = std::make_unique<ClosestPointQuery>(mesh_, context);
}

MeshSurface::~MeshSurface() = default;

std::optional<SurfacePoint> MeshSurface::intersect(Vec3d origin, Vec3d direction) const {
  // The ray starts where it comes near the ball around the mesh, so that far scanners lose no precision.
  const double skip = std::max(0.0, dot(rays_->center - origin, direction) - (1.0 + 1e-6) * rays_->radius);
  const Vec3f start = rays_->to_local(origin + direction * skip);
  const auto along = static_cast<Vec3f>(direction);
  RTCRayHit query{};
  query.ray.org_x = start.x, query.ray.org_y = start.y, query.ray.org_z = start.z;
  query.ray.dir_x = along.x, query.ray.dir_y = along.y, query.ray.dir_z = along.z;
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(rays_->scene.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  // Again in double: where the ray meets the triangle's plane, moved into the triangle if rounding put it outside.
  const uint32_t index = query.hit.primID;
  const Vec3d normal = triangle_normal(mesh_, index);
  const double slope = dot(normal, direction);
  const double coarse = skip + static_cast<double>(query.ray.tfar) * rays_->scale;
  const double exact = dot(mesh_.vertices[mesh_.triangles[index][0]] - origin, normal) / slope;
  const double t = std::abs(slope) > 1e-6 ? exact : coarse;
  const Vec3d p = pull_into_triangle(mesh_, index, origin + direction * t);
  return SurfacePoint{p, normal, dot(p - origin, direction)};
}

SurfacePoint MeshSurface::closest(Vec3d p) const {
  const ClosestPoint found = (*closest_point_)(p);
  return {found.position, triangle_normal(mesh_, found.triangle), found.distance};
}

std::vector<SurfacePoint> MeshSurface::closest_points(const std::vector<Vec3d>& points, const Context& context) const {
  const std::vector<ClosestPoint> found = (*closest_point_)(points, context);
  std::vector<SurfacePoint> answer;
  answer.reserve(found.size());
  for (const ClosestPoint& c : found) answer.push_back({c.position, triangle_normal(mesh_, c.triangle), c.distance});
  return answer;
}

Mesh MeshSurface::tessellate(double /*tolerance*/) const { return mesh_; }

}  // namespace soapfilm
