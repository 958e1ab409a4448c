#include "soapfilm/border/closing.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/grid/ordered_sum.h"

namespace soapfilm {

namespace {

constexpr double asked_for = 0.1;  // of the flux
constexpr int reach = 5;           // vertices
constexpr float notable = 0.05f;   // step of u

float f_at(const Level& level, Vec3i vertex) {
  const int32_t slot = level.grid.find(brick_of(vertex));
  return slot < 0 ? 0.0f
                  : level.data(static_cast<size_t>(slot))[brick_offset(vertex.x & 7, vertex.y & 7, vertex.z & 7)];
}

/// Does the data support a surface between `inner` and the vertex `step` away from it along the axis?
bool is_asked_for(const Level& level, Vec3i inner, int axis, int step, double flux) {
  double against = 0;
  Vec3i v = inner;
  for (int k = 0; k < reach; ++k) {
    v[axis] += step;
    if (!level.box.is_free(v)) break;
    against -= std::min(0.0, double{f_at(level, v)});
  }
  return against >= asked_for * flux;
}

struct Area {
  double all = 0, closing = 0;
  void operator+=(const Area& other) { all += other.all, closing += other.closing; }
};

Area area_of(const Level& level, size_t b, double flux) {
  Area area;
  const float* u = level.u.brick(b);
  const Vec3i first = level.grid.first_vertex(b);
  for (int i = 0; i < brick_volume; ++i) {
    const Vec3i v = first + vertex_in_brick(i);
    if (!level.box.is_free(v)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i next = v;
      ++next[axis];
      if (!level.box.is_free(next)) continue;
      const float step = u[i] - level.u_at(next);
      if (std::abs(step) < notable) continue;
      area.all += std::abs(step);
      const bool asked = step > 0 ? is_asked_for(level, v, axis, 1, flux) : is_asked_for(level, next, axis, -1, flux);
      if (!asked) area.closing += std::abs(step);
    }
  }
  return area;
}

}  // namespace

double closing_share(const Level& level, double flux, const Context& context) {
  const auto area = ordered_sum<Area>(level.grid, context, [&](size_t b) { return area_of(level, b, flux); });
  return area.all > 0 ? area.closing / area.all : 0;
}

}  // namespace soapfilm
