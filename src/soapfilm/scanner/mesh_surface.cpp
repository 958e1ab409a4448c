#include "soapfilm/scanner/mesh_surface.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "soapfilm/core/error.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/evaluate/embree_scene.h"

namespace soapfilm {

namespace {

/// Closest point of triangle abc (Ericson, Real-Time Collision Detection, 5.1.5).
Vec3d closest_on_triangle(Vec3d a, Vec3d b, Vec3d c, Vec3d p) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vec3d bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + ab * (d1 / (d1 - d3));
  const Vec3d cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double scale = 1.0 / (va + vb + vc);
  return a + ab * (vb * scale) + ac * (vc * scale);
}

void check(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw InputError("mesh: 0 triangles, must have at least one");
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!is_finite(mesh.vertices[i])) throw InputError(fmt::format("mesh: vertex {} is not finite", i));
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t v : mesh.triangles[i])
      if (v >= mesh.vertices.size())
        throw InputError(fmt::format("mesh: triangle {} names vertex {}, must be < {}", i, v, mesh.vertices.size()));
}

}  // namespace

/// Embree sees the mesh in single precision, centred and scaled to about [-1, 1].
struct MeshSurface::Embree {
  EmbreeScene tree;
  Vec3d centre;
  double scale = 1.0;  ///< input units per unit of the Embree frame

  Embree(const Mesh& mesh, const Box3d& box) : centre(box.centre()), scale(std::max(0.5 * box.longest(), 1e-300)) {
    rtcSetSceneFlags(tree.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(tree.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcAttachGeometry(tree.get(), geometry);
    rtcReleaseGeometry(geometry);  // the scene holds it from here on
    auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(Vec3f), mesh.vertices.size()));
    auto* triangles = static_cast<Triangle*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size()));
    if (!vertices || !triangles) throw std::bad_alloc();
    std::transform(mesh.vertices.begin(), mesh.vertices.end(), vertices, [&](Vec3d v) { return to_local(v); });
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    rtcCommitGeometry(geometry);
    tree.commit(Parallel(1));
  }

  Vec3f to_local(Vec3d p) const { return static_cast<Vec3f>((p - centre) / scale); }
};

namespace {

struct ClosestQuery {
  const Mesh* mesh;
  Vec3d p;
  double scale;
  double least = std::numeric_limits<double>::infinity();
  Vec3d foot;
  uint32_t triangle = 0;
};

bool visit_triangle(RTCPointQueryFunctionArguments* args) {
  auto& query = *static_cast<ClosestQuery*>(args->userPtr);
  const Triangle& t = query.mesh->triangles[args->primID];
  const auto& v = query.mesh->vertices;
  const Vec3d foot = closest_on_triangle(v[t[0]], v[t[1]], v[t[2]], query.p);
  const double d = norm(query.p - foot);
  // Equal distances go to the lowest index: the order of visits does not show.
  if (d > query.least || (d == query.least && args->primID > query.triangle)) return false;
  const bool closer = d < query.least;
  query.least = d;
  query.foot = foot;
  query.triangle = args->primID;
  // Wider than the distance by what single precision may have moved boxes and query.
  if (closer) args->query->radius = static_cast<float>(d / query.scale * (1.0 + 1e-5) + 1e-6);
  return closer;
}

Vec3d triangle_normal(const Mesh& mesh, uint32_t index) {
  const Triangle& t = mesh.triangles[index];
  const Vec3d a = mesh.vertices[t[0]];
  return normalized(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
}

}  // namespace

MeshSurface::MeshSurface(Mesh mesh) : mesh_(std::move(mesh)) {
  check(mesh_);
  for (const Triangle& t : mesh_.triangles)  // unused vertices are no part of the surface
    for (const uint32_t v : t) box_.extend(mesh_.vertices[v]);
  turned_ = mesh_.volume() < 0.0;
  if (turned_) {
    for (Triangle& t : mesh_.triangles) std::swap(t[1], t[2]);
    for (Vec3f& n : mesh_.normals) n = -n;
  }
  embree_ = std::make_unique<Embree>(mesh_, box_);
}

MeshSurface::~MeshSurface() = default;

std::optional<SurfacePoint> MeshSurface::intersect(Vec3d origin, Vec3d direction) const {
  // The ray starts where it enters the ball around the mesh, so that far scanners lose no precision.
  const double radius = 0.5 * box_.diagonal() * (1.0 + 1e-6);
  const double skip = std::max(0.0, dot(embree_->centre - origin, direction) - radius);
  const Vec3f start = embree_->to_local(origin + direction * skip);
  const Vec3f along = static_cast<Vec3f>(direction);
  RTCRayHit query{};
  query.ray.org_x = start.x, query.ray.org_y = start.y, query.ray.org_z = start.z;
  query.ray.dir_x = along.x, query.ray.dir_y = along.y, query.ray.dir_z = along.z;
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->tree.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  // Again in double: the ray meets the triangle's plane, and the triangle where rounding put it just beside.
  const Triangle& t = mesh_.triangles[query.hit.primID];
  const Vec3d a = mesh_.vertices[t[0]];
  const Vec3d normal = triangle_normal(mesh_, query.hit.primID);
  const double slope = dot(normal, direction);
  const double coarse = skip + static_cast<double>(query.ray.tfar) * embree_->scale;
  const double exact = std::abs(slope) > 1e-6 ? dot(a - origin, normal) / slope : coarse;
  const Vec3d p = closest_on_triangle(a, mesh_.vertices[t[1]], mesh_.vertices[t[2]], origin + direction * exact);
  return SurfacePoint{p, normal, dot(p - origin, direction)};
}

SurfacePoint MeshSurface::closest(Vec3d p) const {
  ClosestQuery closest{&mesh_, p, embree_->scale, std::numeric_limits<double>::infinity(), {}, 0};
  const Vec3f local = embree_->to_local(p);
  RTCPointQuery query{};
  query.x = local.x, query.y = local.y, query.z = local.z;
  query.radius = std::numeric_limits<float>::infinity();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(embree_->tree.get(), &query, &context, visit_triangle, &closest);
  return {closest.foot, triangle_normal(mesh_, closest.triangle), closest.least};
}

Mesh MeshSurface::tessellate(double /*tolerance*/) const { return mesh_; }

}  // namespace soapfilm
