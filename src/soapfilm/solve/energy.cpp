#include "soapfilm/solve/energy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/kernels/energy_kernel.h"
#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

namespace {

struct Evaluator {
  const Level& level;
  std::optional<float> threshold;
  double p_scale;
  EnergyKernel kernel;

  double norm(double x, double y, double z) const {
    return level.norm == Norm::isotropic ? std::sqrt(x * x + y * y + z * z) : std::abs(x) + std::abs(y) + std::abs(z);
  }
  float u_value(float u) const { return threshold ? (u > *threshold ? 1.0f : 0.0f) : u; }

  /// Beyond the places that the level covers u is as in their last layer: their end has no area.
  static void go_on_above(int axis, UpperWindow& u) {
    for (int b = 0; b < brick_side; ++b)
      for (int a = 0; a < brick_side; ++a) {
        if (axis == 0) u.at(8, a, b) = u.at(7, a, b);
        if (axis == 1) u.at(a, 8, b) = u.at(a, 7, b);
        if (axis == 2) u.at(a, b, 8) = u.at(a, b, 7);
      }
  }

  /// The upper halo of the brick at `coord`, whose neighbors come from neighbor(slot) (an index or a missing value).
  template <class Neighbor>
  void fill_upper_halo(Vec3i coord, Neighbor&& neighbor, UpperWindow& u) const {
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t up = neighbor(slot_up[axis]);
      Vec3i above = coord;
      ++above[axis];
      const float* values = up >= 0 ? level.u.brick(static_cast<size_t>(up)) : nullptr;
      if (!values && !level.covers(above)) {
        go_on_above(axis, u);
        continue;
      }
      const float missing = values ? 0.0f : level.missing_u(up, above);
      const auto [first, second] = strides_across(axis);
      for (int b = 0; b < brick_side; ++b)
        for (int a = 0; a < brick_side; ++a) {
          const float value = values ? u_value(values[a * first + b * second]) : missing;
          (axis == 0 ? u.at(8, a, b) : axis == 1 ? u.at(a, 8, b) : u.at(a, b, 8)) = value;
        }
    }
  }

  /// Removes the step from the last free vertices to the fixed ones above them.
  void end_at_border(Vec3i brick, UpperWindow& u) const {
    const Vec3i first = brick * brick_side;
    for (int axis = 0; axis < 3; ++axis) {
      const int last = level.box.free_hi[axis] - first[axis];
      if (last < 0 || last >= brick_side) continue;
      for (int b = 0; b < brick_side; ++b)
        for (int a = 0; a < brick_side; ++a) {
          if (axis == 0) u.at(last + 1, a, b) = u.at(last, a, b);
          if (axis == 1) u.at(a, last + 1, b) = u.at(a, last, b);
          if (axis == 2) u.at(a, b, last + 1) = u.at(a, b, last);
        }
    }
  }

  bool first_layer_is(float constant, size_t brick, int axis) const {
    const float* values = level.u.brick(brick);
    const auto [first, second] = strides_across(axis);
    for (int b = 0; b < brick_side; ++b)
      for (int a = 0; a < brick_side; ++a)
        if (u_value(values[a * first + b * second]) != constant) return false;
    return true;
  }

  /// `gap`: 512 zeros that get each vertex's part, or null.
  EnergyTerms brick_terms(size_t brick, float* gap = nullptr) const {
    UpperWindow u;
    const float* stored = level.u.brick(brick);
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y) {
        const float* row = stored + brick_offset(0, y, z);
        float* values = &u.at(0, y, z);
        if (threshold)
          for (int x = 0; x < brick_side; ++x) values[x] = u_value(row[x]);
        else
          std::copy_n(row, brick_side, values);
      }
    fill_upper_halo(
        level.grid.coord(brick), [&](int slot) { return level.grid.neighbors(brick)[static_cast<size_t>(slot)]; }, u);
    const FreeRange range = free_range(level.box, level.grid.coord(brick));
    if (level.box.open) end_at_border(level.grid.coord(brick), u);
    return kernel({level.p.brick(brick), level.data(brick), low_face(level, brick, 0), low_face(level, brick, 1),
                   low_face(level, brick, 2), range.lo, range.hi, level.lambda, p_scale, level.box.open, gap},
                  u);
  }

  /// Sets the differences from a vertex to its upper neighbors to 0 if they involve a fixed vertex.
  void leave_out_border(Vec3i v, double (&g)[3]) const {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i next = v;
      ++next[axis];
      if (!level.box.is_free(v) || !level.box.is_free(next)) g[axis] = 0;
    }
  }

  /// The faces between an inactive brick and the band above it: u is constant below them.
  EnergyTerms rim_terms(Vec3i coord) const {
    const float constant = level.missing_u(outside_band, coord);
    int32_t up[3];
    bool flat = true;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i above = coord;
      ++above[axis];
      up[axis] = level.grid.find(above);
      flat = flat && (up[axis] < 0 ? !level.covers(above) || level.missing_u(up[axis], above) == constant
                                   : first_layer_is(constant, static_cast<size_t>(up[axis]), axis));
    }
    if (flat) return {};
    UpperWindow u;
    std::fill(std::begin(u.values), std::end(u.values), constant);
    fill_upper_halo(
        coord, [&](int slot) { return slot == slot_up[0]   ? up[0]
                                      : slot == slot_up[1] ? up[1]
                                                           : up[2]; }, u);

    EnergyTerms t;
    const double lambda = level.lambda;
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y)
        for (int x = 0; x < brick_side; ++x) {
          if (x != 7 && y != 7 && z != 7) continue;
          double g[3] = {double{u.at(x + 1, y, z)} - constant, double{u.at(x, y + 1, z)} - constant,
                         double{u.at(x, y, z + 1)} - constant};
          if (level.box.open) leave_out_border(coord * brick_side + Vec3i{x, y, z}, g);
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

/// Inactive bricks of the domain with an active upper neighbor, in order.
std::vector<Vec3i> bricks_below_band(const Level& level, const Context& context) {
  BrickMask below(level.grid.bricks());
  parallel_for(context, level.grid.size(), 1024, [&](size_t b) {
    for (int axis = 0; axis < 3; ++axis)
      if (level.grid.neighbors(b)[static_cast<size_t>(slot_down[axis])] == outside_band) {
        Vec3i coord = level.grid.coord(b);
        --coord[axis];
        if (level.covers(coord)) below.set_shared(coord);
      }
  });
  std::vector<Vec3i> bricks;
  below.for_each([&](Vec3i b) { bricks.push_back(b); });
  return bricks;
}

/// A bound of the variation between gaps of different constant u: 0, unless a band is too narrow.
double outside_variation(const Level& level) {
  if (level.places) return 0;
  const Gaps gaps(level.grid);
  const BrickRange box = BrickRange::whole(level.grid.bricks());
  const BrickRange meant = level.box.open ? box.common(bricks_with_free(level.box)) : box;
  double faces = 0;
  gaps.for_each_contact([&](size_t a, size_t b) {
    if (level.inside[a] != level.inside[b]) faces += shared_faces(gaps[a].common(meant), gaps[b].common(meant));
  });
  if (!level.box.open)
    for (size_t g = 0; g < gaps.size(); ++g)
      if (level.inside[g]) faces += faces_at_end(gaps[g], box);
  return faces * brick_area;
}

/// Of bricks in lattice order: how many, where, and their terms.
template <class Coord, class Term>
struct Bricks {
  size_t count;
  Coord coord;
  Term term;
};
template <class Coord, class Term>
Bricks(size_t, Coord, Term) -> Bricks<Coord, Term>;

template <class Coord, class Term>
EnergyTerms sum_over(const Bricks<Coord, Term>& bricks, const Slabs* slabs, const Context& context) {
  return ordered_sum<EnergyTerms>(bricks.count, slabs, context, bricks.coord, bricks.term);
}

/// The same from one in four bricks, or from all of few.
template <class Coord, class Term>
EnergyTerms estimate_over(const Bricks<Coord, Term>& bricks, const Slabs* slabs, const Context& context) {
  constexpr size_t few = 512, stride = 4;
  if (bricks.count <= few) return sum_over(bricks, slabs, context);
  std::vector<size_t> some;
  for (size_t b = 0; b < bricks.count; ++b)
    if (is_sampled(bricks.coord(b), stride)) some.push_back(b);
  EnergyTerms sum = ordered_sum<EnergyTerms>(
      some.size(), slabs, context, [&](size_t k) { return bricks.coord(some[k]); },
      [&](size_t k) { return bricks.term(some[k]); });
  const double share = some.empty() ? 1 : static_cast<double>(bricks.count) / static_cast<double>(some.size());
  for (double* term : {&sum.variation, &sum.data, &sum.dual, &sum.gap}) *term *= share;
  return sum;
}

/// The active bricks.
auto bricks_of(const Evaluator& evaluator) {
  return Bricks{evaluator.level.grid.size(), [&](size_t b) { return evaluator.level.grid.coord(b); },
                [&](size_t b) {
                  const bool rests = evaluator.level.is_held(static_cast<int32_t>(b));
                  return rests ? EnergyTerms{} : evaluator.brick_terms(b);
                }};
}

/// The inactive ones below them.
auto rim_of(const Evaluator& evaluator, const std::vector<Vec3i>& below) {
  return Bricks{below.size(), [&](size_t b) { return below[b]; },
                [&](size_t b) { return evaluator.rim_terms(below[b]); }};
}

/// From the sum over the band and the inactive bricks below it.
Energies energies_of(const Level& level, const EnergyTerms& sum, double p_scale) {
  const double outside = outside_variation(level);
  Energies e;
  e.total_variation = sum.variation + outside;
  e.data = sum.data + level.outside.data;
  e.primal = level.lambda * e.total_variation - e.data;
  e.dual = sum.dual + level.outside.dual_of_scaled(p_scale);
  e.gap_band = sum.gap + level.lambda * outside;
  e.gap = e.gap_band + level.outside.gap_of_scaled(p_scale);
  e.max_dual_norm = std::sqrt(sum.max_norm_squared) / level.lambda;
  return e;
}

}  // namespace

double Energies::relative_gap(double lambda) const { return gap / std::max(std::abs(dual), 1000 * lambda); }

double Energies::relative_gap_band(double lambda) const { return gap_band / std::max(std::abs(dual), 1000 * lambda); }

Energies evaluate_energy(const Level& level, const EnergyOptions& options, const Context& context) {
  Evaluator evaluator{level, options.threshold, 1.0, kernels_of(context).energy(level.norm)};
  EnergyTerms sum = sum_over(bricks_of(evaluator), level.slabs.get(), context);
  const double max_norm = std::sqrt(sum.max_norm_squared) / level.lambda;
  if (options.certify && max_norm > 1) {
    evaluator.p_scale = 1 / max_norm;
    sum = sum_over(bricks_of(evaluator), level.slabs.get(), context);
  }
  const std::vector<Vec3i> below = bricks_below_band(level, context);
  sum += sum_over(rim_of(evaluator, below), level.slabs.get(), context);
  Energies e = energies_of(level, sum, evaluator.p_scale);
  e.max_dual_norm = max_norm;
  return e;
}

Field<float> local_gap(const Level& level, const EnergyOptions& options, double max_dual_norm, const Context& context) {
  const double p_scale = options.certify ? 1 / std::max(1.0, max_dual_norm) : 1;
  const Evaluator evaluator{level, options.threshold, p_scale, kernels_of(context).energy(level.norm)};
  Field<float> gap(level.grid, pages_of(context));
  const ItemRange own = level.slabs ? bricks_of(level.grid, level.slabs->own()) : ItemRange{0, level.grid.size()};
  parallel_for(context, own.size(), 256, [&](size_t k) {
    const size_t b = own.begin + k;
    float* of_vertex = gap.brick(b);
    evaluator.brick_terms(b, of_vertex);
    for (int v = 0; v < brick_volume; ++v) of_vertex[v] /= level.lambda;
  });
  if (level.slabs)
    bring_all(level.slabs->ranks(), level.slabs->parts([&](Layers layers) { return bricks_of(level.grid, layers); }),
              {{gap.brick(0), brick_volume * sizeof(float)}});
  return gap;
}

double estimate_gap(const Level& level, const Context& context) {
  const Evaluator evaluator{level, {}, 1.0, kernels_of(context).energy(level.norm)};
  EnergyTerms sum = estimate_over(bricks_of(evaluator), level.slabs.get(), context);
  const std::vector<Vec3i> below = bricks_below_band(level, context);
  sum += estimate_over(rim_of(evaluator, below), level.slabs.get(), context);
  return energies_of(level, sum, evaluator.p_scale).relative_gap_band(level.lambda);
}

}  // namespace soapfilm
