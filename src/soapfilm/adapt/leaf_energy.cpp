#include "soapfilm/adapt/leaf_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/adapt/leaf_sides.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/pyramid/children.h"

namespace soapfilm {

namespace {

struct LeafTerms {
  std::array<uint64_t, 4> groups{}, eighths{};  ///< whose u steps along so many axes
  double data = 0, dual = 0, gain = 0, gap_at_borders = 0, max_norm_squared = 0;

  void operator+=(const LeafTerms& t) {
    for (size_t k = 1; k < groups.size(); ++k) {
      groups[k] += t.groups[k];
      eighths[k] += t.eighths[k];
    }
    data += t.data;
    dual += t.dual;
    gain += t.gain;
    gap_at_borders += t.gap_at_borders;
    max_norm_squared = std::max(max_norm_squared, t.max_norm_squared);
  }
  /// In faces of the level.
  double variation(Norm norm) const {
    double sum = 0;
    for (size_t k = 1; k < groups.size(); ++k) {
      const double all = static_cast<double>(groups[k]) + 0.125 * static_cast<double>(eighths[k]);
      sum += all * (norm == Norm::isotropic ? std::sqrt(static_cast<double>(k)) : static_cast<double>(k));
    }
    return sum;
  }
};

/// The leaves of one level.
class LeafEvaluator {
 public:
  LeafEvaluator(const Regions& regions, std::span<const LeafLevel> levels, int level, double p_scale)
      : regions_(regions),
        levels_(levels),
        sides_(regions, levels),
        level_(level),
        own_(levels[static_cast<size_t>(level)]),
        box_(own_.flux->box),
        p_scale_(p_scale) {}

  /// The bricks of the level, in lattice order.
  std::vector<Vec3i> bricks() const {
    std::vector<Vec3i> found;
    const auto add = [&](Vec3i b) {
      if (!regions_.is_finer(level_, b) && !is_plain(b)) found.push_back(b);
    };
    if (level_ == regions_.coarsest()) {
      BrickRange::whole(box_.bricks).for_each(add);
    } else {
      children_of(regions_.finer(level_ + 1), box_.bricks).for_each(add);
    }
    return found;
  }

  LeafTerms terms(Vec3i coord) const {
    LeafTerms t;
    const Brick brick = brick_at(coord);
    const int32_t d = own_.data->grid.find(coord);
    const float* f = d >= 0 ? own_.data->f.brick(static_cast<size_t>(d)) : nullptr;
    const bool parent_has_flux = level_ == regions_.coarsest() || coarser().grid.find(parent_of(coord)) >= 0;
    const bool at_border = brick.has_flux && touches_other_level(coord), steps = !is_constant(brick);
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = vertex_in_brick(i);
      const bool free = box_.is_free(coord * brick_side + v);
      const double u = brick.sides.test(v.x, v.y, v.z) ? 1 : 0, source = f && free ? static_cast<double>(f[i]) : 0;
      const Vec3d p = flux_at(brick, i);
      const double gap = steps ? add_groups(brick, v, p, t) : 0;
      t.data += source * u;
      if (!brick.has_flux) {
        t.gain += parent_has_flux ? 0 : std::max(0.0, source);  // see left_out()
        continue;
      }
      t.max_norm_squared = std::max(t.max_norm_squared, norm_squared(p) / (p_scale_ * p_scale_));
      const double r = free ? into(brick, v, p) - source : 0;
      t.dual += std::min(0.0, r);
      if (at_border) t.gap_at_borders += gap + r * u - std::min(0.0, r);
    }
    return t;
  }

  /// D of the places that have flux from the next coarser level alone.
  double left_out(const Context& context) const {
    if (level_ == regions_.coarsest()) return own_.flux->outside.dual_of_scaled(p_scale_);
    const Level& coarse = coarser();
    return ordered_sum<double>(coarse.grid, context, [&](size_t b) {
      double sum = 0;
      const Vec3i parent = coarse.grid.coord(b);
      for (int k = 0; k < 8 && regions_.is_finer(level_ + 1, parent); ++k)
        if (has_free(box_, child_of(parent, k)) && own_.flux->grid.find(child_of(parent, k)) < 0)
          sum += outside_child(coarse, b, octant_of(k), *own_.data).dual_of_scaled(p_scale_);
      return sum;
    });
  }

 private:
  struct Brick {
    Vec3i coord;
    BrickBits sides;
    std::array<LayerAbove, 3> above;
    bool has_flux = false;
    std::array<const float*, 3> p{};  ///< 512 values each
    std::array<LowFace, 3> low{};
  };
  Brick brick_at(Vec3i coord) const {
    Brick brick{coord, sides_.of(level_, coord), {}, false, {}, {}};
    const int32_t n = own_.flux->grid.find(coord);
    brick.has_flux = n >= 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      brick.above[k] = sides_.above(level_, coord, axis);
      if (n < 0) continue;
      brick.p[k] = own_.flux->p.brick(static_cast<size_t>(n), axis);
      brick.low[k] = low_face(*own_.flux, static_cast<size_t>(n), axis);
    }
    return brick;
  }

  const Level& coarser() const { return *levels_[static_cast<size_t>(level_) + 1].flux; }

  /// Whether a brick and the layers above it have one value.
  static bool is_constant(const Brick& brick) {
    const bool inside = brick.sides.test(0, 0, 0);
    if (brick.sides != (inside ? BrickBits::full() : BrickBits{})) return false;
    const uint16_t row = inside ? 0xffff : 0;
    return std::all_of(brick.above.begin(), brick.above.end(), [&](const LayerAbove& layer) {
      return std::all_of(layer.rows.begin(), layer.rows.end(), [&](uint16_t r) { return r == row; });
    });
  }

  /// Neither energy nor flux.
  bool is_plain(Vec3i b) const {
    return own_.flux->grid.find(b) < 0 && own_.data->grid.find(b) < 0 && sides_.are_alike(level_, b);
  }

  bool touches_other_level(Vec3i brick) const {
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i n = brick + slot_offset(slot);
      if (BrickRange::whole(box_.bricks).contains(n) && !regions_.has(level_, n)) return true;
    }
    return false;
  }

  double norm_squared(Vec3d p) const {
    if (own_.flux->norm == Norm::isotropic) return dot(p, p);
    const double most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return most * most;
  }

  Vec3d flux_at(const Brick& brick, int i) const {
    if (!brick.has_flux) return {};
    const auto at = [&](size_t axis) { return p_scale_ * static_cast<double>(brick.p[axis][i]); };
    return {at(0), at(1), at(2)};
  }

  /// grad^T p at a vertex of a brick.
  double into(const Brick& brick, Vec3i v, Vec3d p) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [a, b] = across(axis);
      const LayerAbove& layer = brick.above[static_cast<size_t>(axis)];
      const double out = v[axis] + 1 == brick_side && layer.finer ? layer.share(v[a], v[b]) : 1;
      if (v[axis] > 0) {
        Vec3i below = v;
        --below[axis];
        const float* along = brick.p[static_cast<size_t>(axis)];
        sum += p_scale_ * static_cast<double>(along[brick_offset(below.x, below.y, below.z)]);
      } else {
        const LowFace& low = brick.low[static_cast<size_t>(axis)];
        sum += share_below(brick.coord, v, axis) * p_scale_ * static_cast<double>(low.at(v[a], v[b]));
      }
      sum -= out * p[axis];
    }
    return sum;
  }

  /// Which share of the face below a vertex of the lowest layer the problem has, where finer leaves are there.
  double share_below(Vec3i brick, Vec3i v, int axis) const {
    Vec3i below = brick;
    --below[axis];
    if (!box_.open || !regions_.is_finer(level_, below)) return 1;
    const LevelBox& fine = levels_[static_cast<size_t>(level_) - 1].flux->box;
    double share = 0;
    for (int k = 0; k < 4; ++k) {
      Vec3i at = (brick * brick_side + v) * 2;
      --at[axis];
      at[across(axis)[0]] += k & 1;
      at[across(axis)[1]] += k >> 1;
      share += fine.is_free(at) ? 0.25 : 0;
    }
    return share;
  }

  /// Adds the groups of a vertex to the variation; returns their part of the gap.
  double add_groups(const Brick& brick, Vec3i v, Vec3d p, LeafTerms& t) const {
    const BrickBits& own = brick.sides;
    const int here = own.test(v.x, v.y, v.z);
    const double lambda = static_cast<double>(own_.flux->lambda);
    bool split = false;
    Vec3i single;  // steps to leaves of the brick, and to those above it that are not finer
    for (int axis = 0; axis < 3; ++axis) {
      const auto [a, b] = across(axis);
      const LayerAbove& layer = brick.above[static_cast<size_t>(axis)];
      const Vec3i up = step_above(v, axis);
      if (up[axis] < brick_side) {
        if (has_face_above(box_, brick.coord * brick_side + v, axis))
          single[axis] = int{own.test(up.x, up.y, up.z)} - here;
      } else if (layer.finer) {
        split = true;
      } else if (layer.has(2 * v[a], 2 * v[b])) {
        single[axis] = int{layer.test(2 * v[a], 2 * v[b])} - here;
      }
    }
    const auto add = [&](Vec3i step, std::array<uint64_t, 4>& counts, double weight) {
      const int axes = std::abs(step.x) + std::abs(step.y) + std::abs(step.z);
      if (axes == 0) return 0.0;
      ++counts[static_cast<size_t>(axes)];
      const double length = own_.flux->norm == Norm::isotropic ? std::sqrt(axes) : axes;
      return weight * (lambda * length - dot(p, Vec3d(step)));
    };
    if (!split) return add(single, t.groups, 1);
    double gap = 0;
    for (int k = 0; k < 8; ++k) {
      const Vec3i octant = octant_of(k);
      Vec3i step = single;
      for (int axis = 0; axis < 3; ++axis) {
        const LayerAbove& layer = brick.above[static_cast<size_t>(axis)];
        if (v[axis] + 1 < brick_side || !layer.finer) continue;
        const auto [a, b] = across(axis);
        const int at_a = 2 * v[a] + octant[a], at_b = 2 * v[b] + octant[b];
        if (layer.has(at_a, at_b)) step[axis] = int{layer.test(at_a, at_b)} - here;
      }
      gap += add(step, t.eighths, 0.125);
    }
    return gap;
  }

  const Regions& regions_;
  std::span<const LeafLevel> levels_;
  LeafSides sides_;
  int level_;
  const LeafLevel& own_;
  const LevelBox& box_;
  double p_scale_;
};

/// The terms of all levels.
struct AllLeaves {
  std::vector<LeafTerms> levels;
  double left_out = 0;

  double max_norm(std::span<const LeafLevel> of) const {
    double most = 0;
    for (size_t l = 0; l < levels.size(); ++l)
      most = std::max(most, std::sqrt(levels[l].max_norm_squared) / static_cast<double>(of[l].flux->lambda));
    return most;
  }
};

AllLeaves sum_leaves(const Regions& regions, std::span<const LeafLevel> levels, double p_scale,
                     const Context& context) {
  AllLeaves sum;
  for (size_t l = 0; l < levels.size(); ++l) {
    const LeafEvaluator evaluator(regions, levels, static_cast<int>(l), p_scale);
    const std::vector<Vec3i> bricks = evaluator.bricks();
    sum.levels.push_back(ordered_sum<LeafTerms>(
        bricks.size(), context, [&](size_t b) { return bricks[b]; },
        [&](size_t b) { return evaluator.terms(bricks[b]); }));
    sum.left_out += evaluator.left_out(context);
  }
  return sum;
}

}  // namespace

LeafEnergies evaluate_leaves(const Regions& regions, std::span<const LeafLevel> levels, int placed,
                             const Context& context) {
  AllLeaves sum = sum_leaves(regions, levels, 1, context);
  const double max_norm = sum.max_norm(levels);
  if (max_norm > 1) sum = sum_leaves(regions, levels, 1 / max_norm, context);
  LeafEnergies found;
  Energies& e = found.energies;
  e.dual = sum.left_out;
  for (size_t l = 0; l < levels.size(); ++l) {
    const LeafTerms& t = sum.levels[l];
    e.total_variation += std::ldexp(t.variation(levels[l].flux->norm), 2 * (static_cast<int>(l) - placed));
    e.data += t.data;
    e.dual += t.dual - t.gain;
    found.at_borders += t.gap_at_borders;
  }
  // The finest level's lambda is a quarter of the next one's, exactly.
  const double lambda = static_cast<double>(levels[static_cast<size_t>(placed)].flux->lambda);
  e.primal = lambda * e.total_variation - e.data;
  e.gap = e.gap_band = e.primal - e.dual;
  e.max_dual_norm = max_norm;
  return found;
}

}  // namespace soapfilm
