#include "soapfilm/solve/energy.h"

#include <algorithm>
#include <cmath>

namespace soapfilm {

namespace {

/// What one brick adds; summed in brick order, so the sums do not depend on threads.
struct Terms {
  double variation = 0;  ///< sum of |grad u|
  double data = 0;       ///< sum of f u
  double dual = 0;       ///< sum of min(0, r), r = grad^T p - f
  double gap = 0;        ///< sum of lambda |grad u| - p . grad u, and of r u - min(0, r)
  double max_norm_squared = 0;
  size_t inside = 0;

  void operator+=(const Terms& t) {
    variation += t.variation;
    data += t.data;
    dual += t.dual;
    gap += t.gap;
    max_norm_squared = std::max(max_norm_squared, t.max_norm_squared);
    inside += t.inside;
  }
};

/// u of a brick and of the vertices one above it: (x, y, z) in [0, 9)^3, without the far edges.
struct UpperWindow {
  static constexpr int side = brick_side + 1;
  double values[side * side * side];
  double& at(int x, int y, int z) { return values[x + side * (y + side * z)]; }
  double at(int x, int y, int z) const { return values[x + side * (y + side * z)]; }
};

struct Evaluator {
  const Level& level;
  std::optional<float> threshold;
  double p_scale = 1;

  double norm(double x, double y, double z) const {
    return level.norm == Norm::isotropic ? std::sqrt(x * x + y * y + z * z) : std::abs(x) + std::abs(y) + std::abs(z);
  }
  double dual_norm_squared(double x, double y, double z) const {
    return level.norm == Norm::isotropic ? x * x + y * y + z * z : std::max({x * x, y * y, z * z});
  }

  double u_value(float u) const { return threshold ? (u > *threshold ? 1.0 : 0.0) : static_cast<double>(u); }

  /// The upper halo of the brick at `coord`, whose neighbours come from neighbor(slot) (an index or a missing value).
  template <class Neighbor>
  void fill_upper_halo(Vec3i coord, Neighbor&& neighbor, UpperWindow& u) const {
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t up = neighbor(slot_up[axis]);
      Vec3i above = coord;
      ++above[axis];
      const float* values = up >= 0 ? level.u.brick(static_cast<size_t>(up)) : nullptr;
      const double missing = values ? 0.0 : level.missing_u(up, above);
      const int first = brick_stride[axis == 0 ? 1 : 0], second = brick_stride[axis == 2 ? 1 : 2];
      for (int b = 0; b < brick_side; ++b)
        for (int a = 0; a < brick_side; ++a) {
          const double value = values ? u_value(values[a * first + b * second]) : missing;
          (axis == 0 ? u.at(8, a, b) : axis == 1 ? u.at(a, 8, b) : u.at(a, b, 8)) = value;
        }
    }
  }

  Terms brick_terms(size_t brick) const {
    UpperWindow u;
    const float* stored = level.u.brick(brick);
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y)
        for (int x = 0; x < brick_side; ++x) u.at(x, y, z) = u_value(stored[brick_offset(x, y, z)]);
    fill_upper_halo(
        level.grid.coord(brick), [&](int slot) { return level.grid.neighbors(brick)[static_cast<size_t>(slot)]; }, u);

    const float* p[3] = {level.p.brick(brick, 0), level.p.brick(brick, 1), level.p.brick(brick, 2)};
    const float* f = level.data(brick);
    const LowFace low[3] = {low_face(level, brick, 0), low_face(level, brick, 1), low_face(level, brick, 2)};
    const FreeRange range = free_range(level.box, level.grid.coord(brick));
    const double lambda = level.lambda;
    Terms t;
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y)
        for (int x = 0; x < brick_side; ++x) {
          const int i = brick_offset(x, y, z);
          const double here = u.at(x, y, z);
          const double gx = u.at(x + 1, y, z) - here, gy = u.at(x, y + 1, z) - here, gz = u.at(x, y, z + 1) - here;
          const double px = p[0][i], py = p[1][i], pz = p[2][i];
          const double length = norm(gx, gy, gz);
          t.variation += length;
          t.gap += lambda * length - p_scale * (px * gx + py * gy + pz * gz);
          t.max_norm_squared = std::max(t.max_norm_squared, dual_norm_squared(px, py, pz));
          if (!range.contains(x, y, z)) continue;
          const double below = (x > 0 ? p[0][i - 1] : low[0].at(y, z)) - px +
                               ((y > 0 ? p[1][i - brick_side] : low[1].at(x, z)) - py) +
                               ((z > 0 ? p[2][i - brick_area] : low[2].at(x, y)) - pz);
          const double r = p_scale * below - f[i];
          t.data += f[i] * here;
          t.dual += std::min(0.0, r);
          t.gap += r * here - std::min(0.0, r);
          t.inside += here > 0.5;
        }
    return t;
  }

  /// The faces through which an inactive brick looks up into the band: u is constant below them.
  Terms rim_terms(Vec3i coord) const {
    const double constant = level.missing_u(outside_band, coord);
    UpperWindow u;
    std::fill(std::begin(u.values), std::end(u.values), constant);
    int32_t up[3];
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i above = coord;
      ++above[axis];
      up[axis] = level.grid.find(above);
    }
    fill_upper_halo(
        coord, [&](int slot) { return slot == slot_up[0]   ? up[0]
                                      : slot == slot_up[1] ? up[1]
                                                           : up[2]; }, u);

    Terms t;
    const double lambda = level.lambda;
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y)
        for (int x = 0; x < brick_side; ++x) {
          if (x != 7 && y != 7 && z != 7) continue;
          const double g[3] = {u.at(x + 1, y, z) - constant, u.at(x, y + 1, z) - constant,
                               u.at(x, y, z + 1) - constant};
          if (g[0] == 0 && g[1] == 0 && g[2] == 0) continue;
          const double length = norm(g[0], g[1], g[2]);
          const int at[3][2] = {{y, z}, {x, z}, {x, y}};
          double coupling = 0;
          for (int axis = 0; axis < 3; ++axis)
            if (g[axis] != 0 && up[axis] >= 0)
              coupling += g[axis] * low_face(level, static_cast<size_t>(up[axis]), axis).at(at[axis][0], at[axis][1]);
          t.variation += length;
          t.gap += lambda * length - p_scale * coupling;
        }
    return t;
  }
};

/// Inactive bricks of the domain with an active upper neighbour, in order.
std::vector<Vec3i> bricks_below_band(const Level& level) {
  BrickMask below(level.box.bricks);
  for (size_t b = 0; b < level.grid.size(); ++b)
    for (int axis = 0; axis < 3; ++axis)
      if (level.grid.neighbors(b)[static_cast<size_t>(slot_down[axis])] == outside_band) {
        Vec3i coord = level.grid.coord(b);
        --coord[axis];
        below.set(coord);
      }
  std::vector<Vec3i> bricks;
  below.for_each([&](Vec3i b) { bricks.push_back(b); });
  return bricks;
}

/// A bound on the variation between inactive bricks of different constant u: none, unless a band is too thin.
double outside_variation(const Level& level) {
  double faces = 0;
  level.inside.for_each([&](Vec3i b) {
    if (level.grid.find(b) >= 0) return;
    for (int axis = 0; axis < 3; ++axis)
      for (int step = -1; step <= 1; step += 2) {
        Vec3i next = b;
        next[axis] += step;
        const int32_t slot = level.grid.find(next);
        if (slot == outside_box || (slot == outside_band && !level.inside.test(next))) faces += brick_area;
      }
  });
  return faces;
}

}  // namespace

double Energies::relative(double amount, double lambda) const {
  return amount / std::max(std::abs(dual), 1000 * lambda);
}

Energies evaluate_energy(const Level& level, const EnergyOptions& options, const Parallel& parallel,
                         std::vector<double>* local_gap) {
  Evaluator evaluator{level, options.threshold, 1.0};
  std::vector<Terms> terms(level.grid.size());
  const auto evaluate_band = [&] {
    parallel.for_each(terms.size(), 256, [&](size_t b) { terms[b] = evaluator.brick_terms(b); });
    Terms sum;
    for (const Terms& t : terms) sum += t;
    return sum;
  };
  Terms sum = evaluate_band();
  const double max_norm = std::sqrt(sum.max_norm_squared) / level.lambda;
  if (options.certify && max_norm > 1) {
    evaluator.p_scale = 1 / max_norm;
    sum = evaluate_band();
  }
  if (local_gap) {
    local_gap->resize(terms.size());
    for (size_t b = 0; b < terms.size(); ++b) (*local_gap)[b] = terms[b].gap;
  }
  for (const Vec3i b : bricks_below_band(level)) sum += evaluator.rim_terms(b);
  const double outside = outside_variation(level);

  Energies e;
  e.total_variation = sum.variation + outside;
  e.data = sum.data;
  e.primal = level.lambda * e.total_variation - e.data;
  e.dual = sum.dual + evaluator.p_scale * level.dual_outside;
  e.gap_band = sum.gap + level.lambda * outside;
  e.gap = e.gap_band + evaluator.p_scale * level.gap_outside;
  e.max_dual_norm = max_norm;
  e.inside = sum.inside;
  return e;
}

}  // namespace soapfilm
