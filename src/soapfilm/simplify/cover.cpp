#include "soapfilm/simplify/cover.h"

namespace soapfilm {

Vec3d ConvexPolygon::mean() const {
  Vec3d sum;
  for (int i = 0; i < count; ++i) sum += at(i);
  return sum / static_cast<double>(count);
}

bool cut(const ConvexPolygon& polygon, Vec3d normal, Vec3d on_plane, ConvexPolygon& above, ConvexPolygon& below) {
  above.count = below.count = 0;
  std::array<double, ConvexPolygon::most> height;
  for (int i = 0; i < polygon.count; ++i) height[static_cast<size_t>(i)] = dot(normal, polygon.at(i) - on_plane);
  for (int i = 0; i < polygon.count; ++i) {
    const int j = (i + 1) % polygon.count;
    const double h = height[static_cast<size_t>(i)], g = height[static_cast<size_t>(j)];
    if (h >= 0 && !above.add(polygon.at(i))) return false;
    if (h <= 0 && !below.add(polygon.at(i))) return false;
    if ((h < 0) == (g < 0) || h == 0 || g == 0) continue;
    const Vec3d crossing = polygon.at(i) + (polygon.at(j) - polygon.at(i)) * (h / (h - g));
    if (!above.add(crossing) || !below.add(crossing)) return false;
  }
  return true;
}

}  // namespace soapfilm
