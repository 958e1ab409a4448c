#include "soapfilm/pyramid/continue_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/pyramid/prolong.h"

namespace soapfilm {

namespace {

/// Shortens the components of p at a vertex that are not given, so that it stays in its ball.
void keep_in_ball(float* p, int i, const std::array<bool, 3>& given, float lambda) {
  float fixed = 0, others = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float along = p[axis * brick_volume + i];
    (given[static_cast<size_t>(axis)] ? fixed : others) += along * along;
  }
  const float most = lambda * lambda - fixed;
  if (others <= most) return;
  const float share = most > 0 ? std::sqrt(most / others) * (1 - 1e-6f) : 0.0f;
  for (int axis = 0; axis < 3; ++axis)
    if (!given[static_cast<size_t>(axis)]) p[axis * brick_volume + i] *= share;
}

/// Takes u and p of a brick from another state, but not the fluxes through faces at the end of the band.
void take(const Level& from, size_t source, Level& level, size_t b) {
  std::copy_n(from.u.brick(source), brick_volume, level.u.brick(b));
  std::vector<float> own(level.p.brick(b), level.p.brick(b) + 3 * brick_volume);
  float* p = level.p.brick(b);
  std::copy_n(from.p.brick(source), 3 * brick_volume, p);
  const auto ends = [&](int axis, int i) {
    return vertex_in_brick(i)[axis] + 1 == brick_side &&
           level.grid.neighbors(b)[static_cast<size_t>(slot_up[axis])] == outside_band;
  };
  for (int i = 0; i < brick_volume; ++i) {
    const std::array<bool, 3> given = {ends(0, i), ends(1, i), ends(2, i)};
    bool changed = false;
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t at = axis * brick_volume + static_cast<size_t>(i);
      if (!given[axis] || p[at] == own[at]) continue;
      p[at] = own[at];
      changed = true;
    }
    if (changed && level.norm == Norm::isotropic) keep_in_ball(p, i, given, level.lambda);
  }
}

const float* values_at(const SupportField& field, Vec3i brick) {
  const int32_t n = field.grid.find(brick);
  return n < 0 ? nullptr : field.f.brick(static_cast<size_t>(n));
}

/// Changes the data of what lies outside, vertex by vertex: min(0, r - f) falls by at most what f grows by.
void change_outside(const NewData& data, Level& level) {
  BrickMask bricks(level.box.bricks);
  add_bricks(data.before.grid, bricks);
  add_bricks(data.now.grid, bricks);
  bricks.for_each([&](Vec3i at) {
    if (level.grid.find(at) >= 0) return;
    const float *before = values_at(data.before, at), *now = values_at(data.now, at);
    const double u = level.missing_u(outside_band, at) > 0 ? 1 : 0;
    for (int i = 0; i < brick_volume; ++i) {
      if (!level.box.is_free(at * brick_side + vertex_in_brick(i))) continue;
      const double more = (now ? double{now[i]} : 0.0) - (before ? double{before[i]} : 0.0);
      const double gain = std::max(0.0, more);
      level.outside += {u * more, gain, -gain, gain - u * more};
    }
  });
}

}  // namespace

Level copy_of(const Level& level, const Context& context) {
  BrickMask bricks(level.box.bricks);
  add_bricks(level.grid, bricks);
  const SupportField none;
  Level copy = make_level(level.box, level.lambda, bricks, none.grid, none.f, context, level.norm);
  copy.f = nullptr;
  copy.inside = level.inside;
  copy.outside = level.outside;
  parallel_for(context, level.grid.size(), 64, [&](size_t b) {
    std::copy_n(level.u.brick(b), brick_volume, copy.u.brick(b));
    std::copy_n(level.p.brick(b), 3 * brick_volume, copy.p.brick(b));
    for (int axis = 0; axis < 3; ++axis)
      if (const float* plane = level.rim.plane(b, axis)) std::copy_n(plane, brick_area, copy.rim.plane(b, axis));
  });
  return copy;
}

void take_known(std::span<const KnownState> known, Level& level, const Context& context) {
  parallel_for(context, level.grid.size(), 64, [&](size_t b) {
    const Vec3i at = level.grid.coord(b);
    for (const KnownState& state : known) {
      const int32_t n = state.level.grid.find(at);
      if (n < 0 || !state.in(at)) continue;
      take(state.level, static_cast<size_t>(n), level, b);
      return;
    }
  });
}

void change_data(Level& level, const NewData& data) {
  level.f = &data.now.f;
  for (size_t b = 0; b < level.grid.size(); ++b)
    level.f_brick[b] = std::max(-1, data.now.grid.find(level.grid.coord(b)));
  change_outside(data, level);
}

Level continue_in_places(const Level& coarse, const LevelBox& box, const BrickMask& band,
                         std::shared_ptr<const BrickMask> places, std::span<const KnownState> known,
                         const SupportField& support, const Context& context) {
  Level level = prolong_in_places(coarse, box, band, std::move(places), support, context, nullptr);
  take_known(known, level, context);
  return level;
}

}  // namespace soapfilm
