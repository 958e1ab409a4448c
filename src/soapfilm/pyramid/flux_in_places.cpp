#include "soapfilm/pyramid/flux_in_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

namespace {

constexpr int most_iterations = 128;

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

/// Whether the fluxes below a brick at the end of the band are those of another state.
bool same_below(const Level& from, size_t source, const Level& level, size_t b) {
  for (int axis = 0; axis < 3; ++axis) {
    const float* plane = level.rim.plane(b, axis);
    if (!plane) continue;
    const LowFace low = low_face(from, source, axis);
    for (int k = 0; k < brick_area; ++k)
      if (plane[k] != low.at(k % brick_side, k / brick_side)) return false;
  }
  return true;
}

/// Takes u and p of a brick from another state, but not the fluxes through faces at the end of the band. Returns
/// whether these are the same.
bool take(const Level& from, size_t source, Level& level, size_t b) {
  bool same = same_below(from, source, level, b);
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
    if (!changed) continue;
    same = false;
    if (level.norm == Norm::isotropic) keep_in_ball(p, i, given, level.lambda);
  }
  return same;
}

/// Takes what is known; the bricks where that leaves p unsettled. `others_settled`: those of which nothing is known
/// are.
BrickMask take_known(std::span<const KnownFlux> known, bool others_settled, Level& level, const Context& context) {
  std::vector<uint8_t> settled(level.grid.size(), others_settled);
  parallel_for(context, level.grid.size(), 64, [&](size_t b) {
    const Vec3i at = level.grid.coord(b);
    for (const KnownFlux& state : known) {
      const int32_t n = state.level.grid.find(at);
      if (n < 0 || !state.in(at)) continue;
      settled[b] = take(state.level, static_cast<size_t>(n), level, b) && state.settled;
      return;
    }
  });
  BrickMask unsettled(level.box.bricks);
  for (size_t b = 0; b < settled.size(); ++b)
    if (settled[b] == 0) unsettled.set(level.grid.coord(b));
  return unsettled;
}

/// Solves these bricks on, and those around them.
void solve_on(const BrickMask& bricks, Level& level, PrimalDualParams params, const Context& context) {
  const BrickMask near = with_neighbors(with_neighbors(bricks));
  level.held.resize(level.grid.size());
  for (size_t b = 0; b < level.grid.size(); ++b) level.held[b] = !near.test(level.grid.coord(b));
  params.max_iterations = std::min(params.max_iterations, most_iterations);
  PrimalDualRun run;
  run.late = run.stalls = true;
  if (bricks.count() > 0) solve_primal_dual(level, params, context, run);
  level.held.clear();
}

/// Adds data that the level has no bricks for to what lies outside: u = 0 or 1 and p as they are, each vertex by
/// itself.
void add_outside(const SupportField& support, Level& level) {
  for (size_t b = 0; b < support.grid.size(); ++b) {
    const Vec3i at = support.grid.coord(b);
    if (level.grid.find(at) >= 0) continue;
    const double u = level.missing_u(outside_band, at) > 0 ? 1 : 0;
    for (int i = 0; i < brick_volume; ++i) {
      if (!level.box.is_free(at * brick_side + vertex_in_brick(i))) continue;
      const double f = static_cast<double>(support.f.brick(b)[i]), gain = std::max(0.0, f);
      level.outside += {u * f, gain, -gain, gain - u * f};
    }
  }
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

void continue_flux(Level& level, std::span<const KnownFlux> known, const SupportField& support,
                   const PrimalDualParams& params, const Context& context) {
  level.f = &support.f;
  for (size_t b = 0; b < level.grid.size(); ++b)
    level.f_brick[b] = std::max(-1, support.grid.find(level.grid.coord(b)));
  add_outside(support, level);
  solve_on(take_known(known, true, level, context), level, params, context);
}

Level flux_in_places(const Level& coarse, const LevelBox& box, const BrickMask& band,
                     std::shared_ptr<const BrickMask> places, std::span<const KnownFlux> known,
                     const SupportField& support, const PrimalDualParams& params, const Context& context) {
  Level level = prolong_in_places(coarse, box, band, std::move(places), support, context, nullptr);
  solve_on(take_known(known, false, level, context), level, params, context);
  return level;
}

}  // namespace soapfilm
