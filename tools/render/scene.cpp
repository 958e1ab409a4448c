#include "tools/render/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/mesh/embree_scene.h"
#include "tools/render/colormap.h"
#include "tools/render/splat.h"

namespace soapfilm::render_detail {

namespace {

constexpr float lift = 1e-4f;      // start of a secondary ray above the surface, scene units
constexpr float disc_lift = 1.5f;  // the same above a sample, in its radii: neighbors must not darken each other
constexpr float far_away = 4;      // viewer's distance, scene units; everything lies within 1 of the origin

/// Sums of the triangles' normals, weighted by their angles at the vertex (Thuermer and Wuethrich 1998): does not
/// depend on how flat parts are cut into triangles.
std::vector<Vec3f> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3d> sums(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3d corner[3] = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const Vec3d n = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
    for (int k = 0; k < 3; ++k) {
      const Vec3d a = normalized(corner[(k + 1) % 3] - corner[k]);
      const Vec3d b = normalized(corner[(k + 2) % 3] - corner[k]);
      sums[t[k]] += n * std::acos(std::clamp(dot(a, b), -1.0, 1.0));
    }
  }
  std::vector<Vec3f> normals(sums.size());
  std::transform(sums.begin(), sums.end(), normals.begin(), [](Vec3d n) { return Vec3f(normalized(n)); });
  return normals;
}

std::vector<Vec3f> attribute_colors(const Mesh& mesh, const std::string& name, std::pair<double, double> range) {
  for (const Column& attribute : mesh.attributes) {
    if (attribute.name != name) continue;
    std::vector<Vec3f> colors(attribute.values.size());
    std::transform(attribute.values.begin(), attribute.values.end(), colors.begin(), [&](float value) {
      return to_linear(map_color((value - range.first) / (range.second - range.first)));
    });
    return colors;
  }
  return {};
}

std::vector<Vec3f> linear_colors(const std::vector<Rgb8>& colors) {
  std::vector<Vec3f> out(colors.size());
  std::transform(colors.begin(), colors.end(), out.begin(), to_linear);
  return out;
}

std::vector<Vec3f> scan_colors(const PointCloud& cloud) {
  std::vector<Vec3f> colors(cloud.size());
  for (size_t s = 0; s < cloud.scans.size(); ++s) {
    std::fill(colors.begin() + static_cast<std::ptrdiff_t>(cloud.scans[s].begin),
              colors.begin() + static_cast<std::ptrdiff_t>(cloud.scans[s].end), to_linear(palette_color(s)));
  }
  return colors;
}

}  // namespace

struct Scene::Impl {
  EmbreeScene scene;
  std::vector<Triangle> triangles;  // empty for points
  std::vector<Vec3f> normals;       // per vertex, camera frame; empty for flat shading
  std::vector<Vec3f> colors;        // per vertex or sample, linear; empty: one for all
  Vec3f surface, back;
  bool two_sided = false;  // points without normals have no inside
  float start = lift;      // of secondary rays

  void attach(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
  }

  void add_mesh(const Mesh& mesh, const RenderParams& params, const ViewFrame& frame, Vec3d center, double scale) {
    const RTCGeometry geometry = rtcNewGeometry(scene.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(Vec3f), mesh.vertices.size()));
    auto* indices = static_cast<Triangle*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   sizeof(Triangle), mesh.triangles.size()));
    std::transform(mesh.vertices.begin(), mesh.vertices.end(), vertices,
                   [&](Vec3d v) { return Vec3f(frame.apply(v - center) * scale); });
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    attach(geometry);
    triangles = mesh.triangles;
    if (params.shading == Shading::smooth) {
      normals = mesh.normals.size() == mesh.vertices.size() ? mesh.normals : vertex_normals(mesh);
      for (Vec3f& n : normals) n = Vec3f(frame.apply(Vec3d(n)));
    }
  }

  void add_points(const PointCloud& cloud, const RenderParams& params, const ViewFrame& frame, Vec3d center,
                  double scale) {
    const bool has_normals = cloud.normals.size() == cloud.size();
    const double world_radius = params.point_radius > 0 ? params.point_radius : splat_radius(cloud.positions);
    const auto radius = static_cast<float>(std::max(world_radius * scale, 1e-6));
    const RTCGeometry geometry = rtcNewGeometry(
        scene.device(), has_normals ? RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT : RTC_GEOMETRY_TYPE_SPHERE_POINT);
    struct Splat {
      Vec3f position;
      float radius;
    };
    auto* splats = static_cast<Splat*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(Splat), cloud.size()));
    for (size_t i = 0; i < cloud.size(); ++i) {
      splats[i] = {Vec3f(frame.apply(cloud.positions[i] - center) * scale), radius};
    }
    if (has_normals) {
      auto* directions = static_cast<Vec3f*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), cloud.size()));
      for (size_t i = 0; i < cloud.size(); ++i) {
        const Vec3d n = normalized(frame.apply(Vec3d(cloud.normals[i])));
        directions[i] = norm(n) > 0 ? Vec3f(n) : Vec3f{0, 0, 1};
      }
    }
    attach(geometry);
    two_sided = !has_normals;
    start = std::max(lift, disc_lift * radius);
  }

  Vec3f at_corners(const std::vector<Vec3f>& values, const RTCHit& hit) const {
    if (triangles.empty()) return values[hit.primID];
    const Triangle& t = triangles[hit.primID];
    return values[t[0]] * (1 - hit.u - hit.v) + values[t[1]] * hit.u + values[t[2]] * hit.v;
  }
};

Scene::Scene(const RenderItem& item, const RenderParams& params, const ViewFrame& frame, Vec3d center, double scale,
             std::pair<double, double> range, const Context& context)
    : impl_(std::make_unique<Impl>()) {
  impl_->surface = to_linear(params.surface);
  impl_->back = to_linear(params.back);
  rtcSetSceneFlags(impl_->scene.get(), RTC_SCENE_FLAG_ROBUST);  // no light through the gaps between triangles
  if (const auto* mesh = std::get_if<const Mesh*>(&item.shape)) {
    impl_->add_mesh(**mesh, params, frame, center, scale);
    impl_->colors = attribute_colors(**mesh, params.color_by, range);
    if (impl_->colors.empty()) impl_->colors = linear_colors((*mesh)->colors);
  } else {
    const PointCloud& cloud = *std::get<const PointCloud*>(item.shape);
    impl_->add_points(cloud, params, frame, center, scale);
    impl_->colors = cloud.colors.empty() && cloud.scans.size() > 1 ? scan_colors(cloud) : linear_colors(cloud.colors);
  }
  impl_->scene.commit(context);
}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;

std::optional<SurfacePoint> Scene::look_at(float x, float y) const {
  RTCRayHit ray{};
  ray.ray.org_x = x;
  ray.ray.org_y = y;
  ray.ray.org_z = far_away;
  ray.ray.dir_z = -1;
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene.get(), &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  SurfacePoint point;
  point.position = {x, y, far_away - ray.ray.tfar};
  point.geometric_normal = normalized(Vec3f{ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z});
  point.normal =
      impl_->normals.empty() ? point.geometric_normal : normalized(impl_->at_corners(impl_->normals, ray.hit));
  if (point.geometric_normal.z < 0) {
    point.is_back = !impl_->two_sided;
    point.geometric_normal = -point.geometric_normal;
    point.normal = -point.normal;
  }
  // An interpolated normal may face away from the viewer near the outline.
  if (point.normal.z < 0) point.normal = normalized(Vec3f{point.normal.x, point.normal.y, 0});
  point.color = point.is_back           ? impl_->back
                : impl_->colors.empty() ? impl_->surface
                                        : impl_->at_corners(impl_->colors, ray.hit);
  return point;
}

void Scene::test_occlusion(const SurfacePoint& from, OcclusionRays& rays) const {
  const Vec3f origin = from.position + from.geometric_normal * impl_->start;
  RTCRay8 packet8{};
  alignas(32) int valid[packet];
  for (int i = 0; i < packet; ++i) {
    valid[i] = i < rays.count ? -1 : 0;
    if (i >= rays.count) continue;
    packet8.org_x[i] = origin.x;
    packet8.org_y[i] = origin.y;
    packet8.org_z[i] = origin.z;
    packet8.dir_x[i] = rays.x[i];
    packet8.dir_y[i] = rays.y[i];
    packet8.dir_z[i] = rays.z[i];
    packet8.tfar[i] = rays.reach[i];
    packet8.mask[i] = ~0u;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded8(valid, impl_->scene.get(), &context, &packet8);
  for (int i = 0; i < rays.count; ++i) rays.visible[i] = packet8.tfar[i] < 0 ? 0.f : 1.f;
}

}  // namespace soapfilm::render_detail
