#include "soapfilm/adapt/leaf_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/pyramid/children.h"

namespace soapfilm {

namespace {

/// The two axes across one.
constexpr std::array<int, 2> across(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

Vec3i step_up(Vec3i v, int axis) {
  ++v[axis];
  return v;
}

/// u of a brick, of the level that its place has.
class Sides {
 public:
  Sides(const Regions& regions, std::span<const LeafLevel> levels) : regions_(regions), levels_(levels) {}

  BrickBits of(int level, Vec3i brick) const {
    const Labels& labels = *levels_[static_cast<size_t>(level)].sides;
    if (!follows(level, brick)) return labels.of(brick);
    const BrickBits parent = of(level + 1, parent_of(brick));
    const Vec3i base = octant_base(octant_in_parent(brick));
    BrickBits bits;
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = base + vertex_in_brick(i) / 2;
      if (parent.test(v.x, v.y, v.z)) bits.set(i);
    }
    return bits;
  }
  /// Whether a leaf brick and those above it have one value without having labels.
  bool are_alike(int level, Vec3i brick) const {
    const Labels& labels = *levels_[static_cast<size_t>(level)].sides;
    const auto missing = [&](Vec3i b) {
      return regions_.has(level, b) && !follows(level, b) && labels.grid.find(b) == outside_band;
    };
    if (!missing(brick)) return false;
    const bool inside = labels.is_inside(outside_band, brick);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3i up = step_up(brick, axis);
      if (!missing(up) || labels.is_inside(outside_band, up) != inside) return false;
    }
    return true;
  }

 private:
  bool follows(int level, Vec3i brick) const {
    return level < regions_.coarsest() && regions_.follows(level + 1, parent_of(brick));
  }

  const Regions& regions_;
  std::span<const LeafLevel> levels_;
};

/// u in the layer above a brick, of half its width: (2a + i, 2b + j) for the sub-face (i, j) of vertex (a, b).
struct LayerAbove {
  std::array<uint16_t, 2 * brick_side> rows{};
  std::array<uint16_t, 2 * brick_side> exists{};  ///< sub-faces that the problem has
  bool finer = false;

  bool test(int a, int b) const { return rows[static_cast<size_t>(b)] >> a & 1; }
  bool has(int a, int b) const { return exists[static_cast<size_t>(b)] >> a & 1; }
  /// What share of a vertex's face the problem has.
  double share(int a, int b) const {
    return 0.25 * (has(2 * a, 2 * b) + has(2 * a + 1, 2 * b) + has(2 * a, 2 * b + 1) + has(2 * a + 1, 2 * b + 1));
  }
};

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
      BrickMask places(box_.bricks);
      regions_.finer(level_ + 1).for_each([&](Vec3i parent) {
        for (int k = 0; k < 8; ++k) places.set(child_of(parent, k));
      });
      places.for_each(add);
    }
    return found;
  }

  LeafTerms terms(Vec3i brick) const {
    LeafTerms t;
    const BrickBits own = sides_.of(level_, brick);
    std::array<LayerAbove, 3> above;
    for (int axis = 0; axis < 3; ++axis) above[static_cast<size_t>(axis)] = layer_above(brick, axis);
    const int32_t n = own_.flux->grid.find(brick), d = own_.data->grid.find(brick);
    const float* f = d >= 0 ? own_.data->f.brick(static_cast<size_t>(d)) : nullptr;
    const bool at_border = n >= 0 && touches_other_level(brick);
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = vertex_in_brick(i);
      const bool free = box_.is_free(brick * brick_side + v);
      const double u = own.test(v.x, v.y, v.z) ? 1 : 0, source = f && free ? static_cast<double>(f[i]) : 0;
      const Vec3d p = n >= 0 ? flux_at(static_cast<size_t>(n), i) : Vec3d();
      const double gap = add_groups(brick, v, own, above, p, t);
      t.data += source * u;
      if (n < 0) {
        t.gain += std::max(0.0, source);
        continue;
      }
      t.max_norm_squared = std::max(t.max_norm_squared, norm_squared(p) / (p_scale_ * p_scale_));
      const double r = free ? into(brick, static_cast<size_t>(n), v, above, p) - source : 0;
      t.dual += std::min(0.0, r);
      if (at_border) t.gap_at_borders += gap + r * u - std::min(0.0, r);
    }
    return t;
  }

  /// D of the places that have flux from the next coarser level alone.
  double left_out(const Context& context) const {
    if (level_ == regions_.coarsest()) return own_.flux->outside.dual_of_scaled(p_scale_);
    const Level& coarse = *levels_[static_cast<size_t>(level_) + 1].flux;
    const SupportField none;
    return p_scale_ * ordered_sum<double>(coarse.grid, context, [&](size_t b) {
             double sum = 0;
             const Vec3i parent = coarse.grid.coord(b);
             for (int k = 0; k < 8 && regions_.is_finer(level_ + 1, parent); ++k)
               if (has_free(box_, child_of(parent, k)) && own_.flux->grid.find(child_of(parent, k)) < 0)
                 sum += outside_child(coarse, b, octant_of(k), none).dual;
             return sum;
           });
  }

 private:
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

  Vec3d flux_at(size_t n, int i) const {
    Vec3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = p_scale_ * static_cast<double>(own_.flux->p.brick(n, axis)[i]);
    return p;
  }

  /// grad^T p at a vertex of a brick.
  double into(Vec3i brick, size_t n, Vec3i v, const std::array<LayerAbove, 3>& above, Vec3d p) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [a, b] = across(axis);
      const LayerAbove& layer = above[static_cast<size_t>(axis)];
      const double out = v[axis] + 1 == brick_side && layer.finer ? layer.share(v[a], v[b]) : 1;
      if (v[axis] > 0) {
        Vec3i below = v;
        --below[axis];
        sum += p_scale_ * static_cast<double>(own_.flux->p.brick(n, axis)[brick_offset(below.x, below.y, below.z)]);
      } else {
        sum +=
            share_below(brick, v, axis) * p_scale_ * static_cast<double>(low_face(*own_.flux, n, axis).at(v[a], v[b]));
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
  double add_groups(Vec3i brick, Vec3i v, const BrickBits& own, const std::array<LayerAbove, 3>& above, Vec3d p,
                    LeafTerms& t) const {
    const int here = own.test(v.x, v.y, v.z);
    const double lambda = static_cast<double>(own_.flux->lambda);
    bool split = false;
    Vec3i single;  // steps to leaves of the brick, and to those above it that are not finer
    for (int axis = 0; axis < 3; ++axis) {
      const auto [a, b] = across(axis);
      const LayerAbove& layer = above[static_cast<size_t>(axis)];
      const Vec3i up = step_up(v, axis);
      if (up[axis] < brick_side) {
        if (exists(brick, v, axis)) single[axis] = int{own.test(up.x, up.y, up.z)} - here;
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
        const LayerAbove& layer = above[static_cast<size_t>(axis)];
        if (v[axis] + 1 < brick_side || !layer.finer) continue;
        const auto [a, b] = across(axis);
        const int at_a = 2 * v[a] + octant[a], at_b = 2 * v[b] + octant[b];
        if (layer.has(at_a, at_b)) step[axis] = int{layer.test(at_a, at_b)} - here;
      }
      gap += add(step, t.eighths, 0.125);
    }
    return gap;
  }

  /// Whether the face above a vertex has area.
  bool exists(Vec3i brick, Vec3i v, int axis) const {
    const Vec3i at = brick * brick_side + v;
    return !box_.open || (box_.is_free(at) && box_.is_free(step_up(at, axis)));
  }

  LayerAbove layer_above(Vec3i brick, int axis) const {
    const Vec3i next = step_up(brick, axis);
    const auto [a, b] = across(axis);
    LayerAbove layer;
    const bool beyond = !BrickRange::whole(box_.bricks).contains(next);
    layer.finer = !beyond && regions_.is_finer(level_, next);
    std::array<BrickBits, 4> finer;
    BrickBits other;
    Vec3i base;
    int step = 2;  // half vertices per vertex of `other`
    if (layer.finer) {
      for (int k = 0; k < 4; ++k) finer[static_cast<size_t>(k)] = sides_.of(level_ - 1, child_above(next, axis, k));
    } else if (!beyond && regions_.has(level_, next)) {
      other = sides_.of(level_, next);
    } else if (!beyond) {
      other = sides_.of(level_ + 1, parent_of(next));
      base = octant_base(octant_in_parent(next));
      step = 4;
    }
    for (int y = 0; y < 2 * brick_side; ++y)
      for (int x = 0; x < 2 * brick_side; ++x) {
        Vec3i at;
        at[a] = layer.finer ? x % brick_side : x / step;
        at[b] = layer.finer ? y % brick_side : y / step;
        const BrickBits& bits = layer.finer ? finer[static_cast<size_t>(x / brick_side + 2 * (y / brick_side))] : other;
        const Vec3i in = layer.finer ? at : base + at;
        const auto bit = static_cast<uint16_t>(1 << x);
        if (bits.test(in.x, in.y, in.z)) layer.rows[static_cast<size_t>(y)] |= bit;
        if (face_exists(brick, axis, x, y, layer.finer)) layer.exists[static_cast<size_t>(y)] |= bit;
      }
    return layer;
  }

  static Vec3i child_above(Vec3i next, int axis, int k) {
    Vec3i octant;
    octant[across(axis)[0]] = k & 1;
    octant[across(axis)[1]] = k >> 1;
    return child_of(next, octant);
  }

  /// Of the sub-face (x, y) above a brick.
  bool face_exists(Vec3i brick, int axis, int x, int y, bool finer) const {
    if (!box_.open) return true;
    Vec3i v;
    v[axis] = brick_side - 1;
    v[across(axis)[0]] = x / 2;
    v[across(axis)[1]] = y / 2;
    if (!finer) return exists(brick, v, axis);
    Vec3i fine = step_up(brick, axis) * (2 * brick_side);
    fine[across(axis)[0]] += x;
    fine[across(axis)[1]] += y;
    return box_.is_free(brick * brick_side + v) && levels_[static_cast<size_t>(level_) - 1].flux->box.is_free(fine);
  }

  const Regions& regions_;
  std::span<const LeafLevel> levels_;
  Sides sides_;
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
  // What the coarsest level has outside of its bricks holds for its data there, too.
  sum.levels.back().gain = 0;
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
