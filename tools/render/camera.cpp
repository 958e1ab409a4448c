#include "tools/render/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

Vec3d unit(Vec3d v, const char* name) {
  if (!is_finite(v) || norm(v) == 0) {
    throw ParameterError(fmt::format("{} = {:g},{:g},{:g}, must be finite and not zero", name, v.x, v.y, v.z));
  }
  return normalized(v / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
}

/// Towards the viewer of the front view: +z, or -y where that is (nearly) upright.
Vec3d front_of(Vec3d up) {
  const Vec3d candidate = std::abs(up.z) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{0, -1, 0};
  return normalized(candidate - up * dot(candidate, up));
}

}  // namespace

ViewFrame view_frame(Vec3d from, Vec3d up) {
  ViewFrame frame;
  frame.towards_viewer = unit(from, "view");
  const Vec3d upright = unit(up, "up");
  const double along = dot(frame.towards_viewer, upright);
  const Vec3d in_plane = std::abs(along) > 1 - 1e-9 ? front_of(upright) * (along > 0 ? -1.0 : 1.0) : upright;
  frame.right = normalized(cross(in_plane, frame.towards_viewer));
  frame.up = cross(frame.towards_viewer, frame.right);
  return frame;
}

Vec3d view_direction(std::string_view name, Vec3d up) {
  const Vec3d top = unit(up, "up");
  const Vec3d front = front_of(top);
  const Vec3d right = cross(top, front);
  if (name == "front") return front;
  if (name == "back") return -front;
  if (name == "right") return right;
  if (name == "left") return -right;
  if (name == "top") return top;
  if (name == "bottom") return -top;
  if (name == "iso") return normalized(front + right * 0.7 + top * 0.6);
  throw ParameterError(
      fmt::format("view = {}, must be front, back, left, right, top, bottom, iso or three numbers X,Y,Z", name));
}

ViewExtent extent_of(const std::vector<Vec3d>& positions, const ViewFrame& frame) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  ViewExtent e{infinity, -infinity, infinity, -infinity};
  for (const Vec3d& p : positions) {
    const double x = dot(p, frame.right);
    const double y = dot(p, frame.up);
    e.lo_x = std::min(e.lo_x, x);
    e.hi_x = std::max(e.hi_x, x);
    e.lo_y = std::min(e.lo_y, y);
    e.hi_y = std::max(e.hi_y, y);
  }
  return e;
}

ViewWindow zoomed(const ViewWindow& window, const ZoomBox& zoom, double aspect) {
  ViewWindow out;
  out.x = window.x + (zoom.x0 + zoom.x1 - 1) * window.half_height * aspect;
  out.y = window.y - (zoom.y0 + zoom.y1 - 1) * window.half_height;
  out.half_height = window.half_height * std::max(zoom.x1 - zoom.x0, zoom.y1 - zoom.y0);
  return out;
}

}  // namespace soapfilm
