#include "tools/measure/above_plane.h"

#include <cmath>
#include <utility>

namespace soapfilm {

namespace {

/// Share of a surface's projected area that is left when up and down cancel: more, and it looks to one side mostly.
constexpr double least_of_sheet = 0.5;

/// Projected area and volume under a polygon, signed by the side that it shows to the normal.
struct Share {
  double area = 0, volume = 0;
  double unsigned_area = 0;
};

Share share_of(const Polygon& polygon, const Plane& plane) {
  Share share;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const Vec3d a = polygon[0], b = polygon[i - 1], c = polygon[i];
    const double area = 0.5 * dot(plane.normal, cross(b - a, c - a));
    share.area += area;
    share.unsigned_area += std::abs(area);
    share.volume += area * (dot(plane.normal, a) + dot(plane.normal, b) + dot(plane.normal, c)) / 3;
  }
  return share;
}

Polygon within(Polygon polygon, const Window& w) {
  polygon = clipped(polygon, [&](Vec3d p) { return p.x - w.lo_x; });
  polygon = clipped(polygon, [&](Vec3d p) { return w.hi_x - p.x; });
  polygon = clipped(polygon, [&](Vec3d p) { return p.y - w.lo_y; });
  return clipped(polygon, [&](Vec3d p) { return w.hi_y - p.y; });
}

}  // namespace

VolumeAtPlane volume_at_plane(const Mesh& mesh, bool closed, const Plane& plane, const std::optional<Window>& window) {
  // Around a point of the plane, so that georeferenced coordinates do not cancel.
  const Plane here{{}, plane.normal};
  std::optional<Window> local = window;
  if (local)
    local = {window->lo_x - plane.point.x, window->lo_y - plane.point.y, window->hi_x - plane.point.x,
             window->hi_y - plane.point.y};
  Share above, below;
  for (const Triangle& t : mesh.triangles) {
    Polygon polygon;
    for (const uint32_t v : t) polygon.push_back(mesh.vertices[v] - plane.point);
    if (local) polygon = within(std::move(polygon), *local);
    const Share up = share_of(clipped(polygon, [&](Vec3d p) { return here.height(p); }), here);
    const Share down = share_of(clipped(polygon, [&](Vec3d p) { return -here.height(p); }), here);
    above.area += up.area, above.volume += up.volume, above.unsigned_area += up.unsigned_area;
    below.area += down.area, below.volume += down.volume, below.unsigned_area += down.unsigned_area;
  }
  const double area = above.area + below.area, unsigned_area = above.unsigned_area + below.unsigned_area;
  const bool sheet = !closed && std::abs(area) > least_of_sheet * unsigned_area;
  if (!sheet) return {above.volume, below.volume, above.area, below.area, false};
  const double side = area < 0 ? -1 : 1;
  return {side * above.volume, -side * below.volume, side * above.area, side * below.area, true};
}

}  // namespace soapfilm
