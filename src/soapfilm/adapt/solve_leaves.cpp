#include "soapfilm/adapt/solve_leaves.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "soapfilm/adapt/leaf_sides.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/pyramid/children.h"
#include "soapfilm/solve/sweep.h"

namespace soapfilm {

namespace {

/// Index in a layer of 8 x 8 values.
constexpr size_t in_layer(int a, int b) { return static_cast<size_t>(a + brick_side * b); }

/// Of a vertex in the last layer of a brick along an axis.
int in_last_layer(int axis, int a, int b) {
  Vec3i v;
  v[axis] = brick_side - 1;
  v[across(axis)[0]] = a;
  v[across(axis)[1]] = b;
  return brick_offset(v.x, v.y, v.z);
}

/// The rows of a brick that hold value (a, b) of its first or last layer along an axis.
RowMask row_at(int axis, bool last, int a, int b) {
  const int y = axis == 0 ? a : axis == 1 ? (last ? brick_side - 1 : 0) : b;
  const int z = axis == 2 ? (last ? brick_side - 1 : 0) : b;
  return RowMask{1} << (y + brick_side * z);
}

/// Writes a value; returns whether it is another one.
bool replace(float& at, float value) {
  const bool other = at != value;
  at = value;
  return other;
}

/// A brick whose values at faces are those of leaves of another level.
struct Follower {
  size_t brick;
  bool finer;                       ///< these are finer
  std::array<bool, 3> lead, trail;  ///< along each axis: a leaf lies below it, which reads its u_bar; above it, its p
  std::array<int32_t, 8> leaves;    ///< bricks of the other level's grid: its children, or its parent alone
  Vec3i octant;                     ///< in the parent
};

/// The leaves of one level.
class LevelLeaves {
 public:
  LevelLeaves(Level& level, const Regions& regions, int number, const Context& context)
      : level_(level), context_(context), leading_(level.grid.size()) {
    level.held.assign(level.grid.size(), Held::rests);
    for (size_t b = 0; b < level.grid.size(); ++b)
      if (regions.has(number, level.grid.coord(b))) level.held[b] = Held::no;
    for (size_t b = 0; b < level.grid.size(); ++b)
      if (level.held[b] != Held::no) find_follower(b, regions.is_finer(number, level.grid.coord(b)));
    for (const Follower& f : followers_) level.held[f.brick] = Held::follows;
    sweeper_ = std::make_unique<Sweeper>(level, context);
  }
  LevelLeaves(const LevelLeaves&) = delete;
  LevelLeaves& operator=(const LevelLeaves&) = delete;

  /// Finds the leaves of the followers in the levels around; null: there is none.
  void connect(LevelLeaves* finer, LevelLeaves* coarser) {
    finer_ = finer;
    coarser_ = coarser;
    for (Follower& f : followers_) {
      const Vec3i at = level_.grid.coord(f.brick);
      for (int k = 0; f.finer && k < 8; ++k)
        f.leaves[static_cast<size_t>(k)] = finer->level_.grid.find(child_of(at, k));
      if (!f.finer) f.leaves[0] = coarser->level_.grid.find(parent_of(at));
      for (int axis = 0; axis < 3; ++axis) {
        if (!f.lead[static_cast<size_t>(axis)]) continue;
        if (!f.finer) coarser->leading_[static_cast<size_t>(f.leaves[0])] |= static_cast<uint8_t>(1 << axis);
        for (int k = 0; f.finer && k < 8; ++k)
          if (const int32_t leaf = f.leaves[static_cast<size_t>(k)]; octant_of(k)[axis] == 0 && leaf >= 0)
            finer->leading_[static_cast<size_t>(leaf)] |= static_cast<uint8_t>(1 << axis);
      }
    }
  }

  /// What the next primal step reads: p that flows in from other levels.
  void follow_p() {
    parallel_for(context_, followers_.size(), 16, [&](size_t k) {
      const Follower& f = followers_[k];
      RowMask p = 0;
      for (int axis = 0; axis < 3; ++axis)
        if (f.trail[static_cast<size_t>(axis)]) p |= f.finer ? summed_flux(f, axis) : shared_flux(f, axis);
      sweeper_->follow(f.brick, 0, p);
    });
  }

  /// u_bar of the next primal step at faces toward other levels. It is not in the sweeper's faces yet, and these
  /// levels' dual steps follow at once.
  void look_ahead(double balance) {
    const float tau = steps(balance).tau;
    parallel_for(context_, level_.grid.size(), 256, [&](size_t b) {
      for (int axis = 0; axis < 3; ++axis)
        if (leading_[b] >> axis & 1) look_ahead(b, axis, tau);
    });
  }

  /// What the next dual step reads: u_bar of other levels.
  void follow_u() {
    parallel_for(context_, followers_.size(), 16, [&](size_t k) {
      const Follower& f = followers_[k];
      RowMask u_bar = 0;
      for (int axis = 0; axis < 3; ++axis)
        if (f.lead[static_cast<size_t>(axis)]) u_bar |= f.finer ? mean_faces(f, axis) : repeated_faces(f, axis);
      sweeper_->follow(f.brick, u_bar, 0);
    });
  }

  void sweep(double balance) { sweeper_->sweep(steps(balance), 1); }

 private:
  StepSizes steps(double balance) const { return step_sizes(balance * static_cast<double>(level_.lambda)); }
  bool is_leaf(int32_t brick) const { return brick >= 0 && level_.held[static_cast<size_t>(brick)] == Held::no; }

  void find_follower(size_t b, bool finer) {
    Follower f{b, finer, {}, {}, {}, octant_in_parent(level_.grid.coord(b))};
    bool follows = false;
    for (size_t axis = 0; axis < 3; ++axis) {
      f.lead[axis] = is_leaf(level_.grid.neighbors(b)[static_cast<size_t>(slot_down[axis])]);
      f.trail[axis] = is_leaf(level_.grid.neighbors(b)[static_cast<size_t>(slot_up[axis])]);
      follows = follows || f.lead[axis] || f.trail[axis];
    }
    if (follows) followers_.push_back(f);
  }

  /// The primal step (solve/level_solver.h) at a brick's first layer along an axis.
  void look_ahead(size_t b, int axis, float tau) {
    const std::array<LowFace, 3> low{low_face(level_, b, 0), low_face(level_, b, 1), low_face(level_, b, 2)};
    const FreeRange free = free_range(level_.box, level_.grid.coord(b));
    const float *u = level_.u.brick(b), *f = level_.data(b);
    for (int i = 0; i < brick_area; ++i) {
      Vec3i v;
      v[across(axis)[0]] = i % brick_side;
      v[across(axis)[1]] = i / brick_side;
      const int at = brick_offset(v.x, v.y, v.z);
      float in = 0;
      for (int k = 0; k < 3; ++k) {
        const float* p = level_.p.brick(b, k);
        const float below =
            v[k] > 0 ? p[at - brick_stride[k]] : low[static_cast<size_t>(k)].at(v[across(k)[0]], v[across(k)[1]]);
        in += below - p[at];
      }
      const float cap = free.contains(v.x, v.y, v.z) ? 1.0f : 0.0f;
      const float next = std::min(std::max(u[at] - tau * (in - f[at]), 0.0f), cap);
      sweeper_->faces(b)[axis * brick_area + i] = next + next - u[at];
    }
  }

  /// The finer brick that touches value (a, b) of a follower's layer, negative beyond the box, and the first of its
  /// four values there.
  struct Quarter {
    int32_t brick;
    int a, b;
  };
  static Quarter quarter(const Follower& f, int axis, bool last, int a, int b) {
    Vec3i octant;
    octant[axis] = last;
    octant[across(axis)[0]] = a / half_brick;
    octant[across(axis)[1]] = b / half_brick;
    const auto k = static_cast<size_t>(octant.x + 2 * octant.y + 4 * octant.z);
    return {f.leaves[k], 2 * a % brick_side, 2 * b % brick_side};
  }

  /// set(a, b) writes a value of a layer and says whether it is another one; the rows with others.
  template <class Set>
  static RowMask rows_of_layer(int axis, bool last, Set&& set) {
    RowMask rows = 0;
    for (int b = 0; b < brick_side; ++b)
      for (int a = 0; a < brick_side; ++a)
        if (set(a, b)) rows |= row_at(axis, last, a, b);
    return rows;
  }
  float& face(size_t brick, int axis, int a, int b) {
    return sweeper_->faces(brick)[static_cast<size_t>(axis * brick_area) + in_layer(a, b)];
  }
  float& flux(size_t brick, int axis, int a, int b) { return level_.p.brick(brick, axis)[in_last_layer(axis, a, b)]; }

  RowMask mean_faces(const Follower& f, int axis) {
    return rows_of_layer(axis, false, [&](int a, int b) {
      const Quarter q = quarter(f, axis, false, a, b);
      if (q.brick < 0) return false;
      const float* at = &finer_->face(static_cast<size_t>(q.brick), axis, q.a, q.b);
      return replace(face(f.brick, axis, a, b), 0.25f * ((at[0] + at[1]) + (at[brick_side] + at[brick_side + 1])));
    });
  }
  RowMask repeated_faces(const Follower& f, int axis) {
    const Vec3i base = octant_base(f.octant);
    const int first = across(axis)[0], second = across(axis)[1];
    return rows_of_layer(axis, false, [&](int a, int b) {
      const auto from = static_cast<size_t>(f.leaves[0]);
      return replace(face(f.brick, axis, a, b), coarser_->face(from, axis, base[first] + a / 2, base[second] + b / 2));
    });
  }
  RowMask summed_flux(const Follower& f, int axis) {
    return rows_of_layer(axis, true, [&](int a, int b) {
      const Quarter q = quarter(f, axis, true, a, b);
      if (q.brick < 0) return false;
      const auto at = [&](int i, int j) { return finer_->flux(static_cast<size_t>(q.brick), axis, q.a + i, q.b + j); };
      return replace(flux(f.brick, axis, a, b), (at(0, 0) + at(1, 0)) + (at(0, 1) + at(1, 1)));
    });
  }
  RowMask shared_flux(const Follower& f, int axis) {
    const Vec3i base = octant_base(f.octant);
    const int first = across(axis)[0], second = across(axis)[1];
    return rows_of_layer(axis, true, [&](int a, int b) {
      const auto from = static_cast<size_t>(f.leaves[0]);
      return replace(flux(f.brick, axis, a, b),
                     face_share * coarser_->flux(from, axis, base[first] + a / 2, base[second] + b / 2));
    });
  }

  Level& level_;
  const Context& context_;
  LevelLeaves *finer_ = nullptr, *coarser_ = nullptr;
  std::vector<Follower> followers_;
  std::vector<uint8_t> leading_;  ///< of each brick, a bit for each axis: followers of other levels read its u_bar
  std::unique_ptr<Sweeper> sweeper_;
};

/// Calls visit(brick, axis, step) for the six bricks beside one.
template <class Visit>
void for_each_beside(Vec3i brick, Visit&& visit) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      Vec3i beside = brick;
      beside[axis] += step;
      visit(beside, axis, step);
    }
}

}  // namespace

BrickMask with_followers(const Regions& regions, int level, BrickMask bricks, const BrickGrid& coarser) {
  // Of bricks with finer leaves beside coarser ones the children that touch these are solved, too.
  for (size_t b = 0; b < coarser.size(); ++b) {
    const Vec3i leaf = coarser.coord(b);
    if (!regions.has(level + 1, leaf)) continue;
    for_each_beside(leaf, [&](Vec3i beside, int axis, int step) {
      if (coarser.find(beside) < 0 || !regions.is_finer(level + 1, beside)) return;
      for (int k = 0; k < 8; ++k) {
        const Vec3i child = child_of(beside, k);
        if (octant_of(k)[axis] == (step < 0) && bricks.contains(child)) bricks.set(child);
      }
    });
  }
  BrickMask all = bricks;
  bricks.for_each([&](Vec3i brick) {
    for_each_beside(brick, [&](Vec3i beside, int, int) {
      if (!bricks.contains(beside) || regions.is_finer(level + 1, parent_of(beside))) return;
      if (coarser.find(parent_of(beside)) >= 0) all.set(beside);
    });
  });
  return all;
}

void solve_leaves(const Regions& regions, std::span<Level> levels, const LeafIteration& how, const Context& context,
                  const std::function<bool(int)>& ends) {
  std::deque<LevelLeaves> leaves;
  for (size_t l = 0; l < levels.size(); ++l) leaves.emplace_back(levels[l], regions, static_cast<int>(l), context);
  for (size_t l = 0; l < leaves.size(); ++l)
    leaves[l].connect(l > 0 ? &leaves[l - 1] : nullptr, l + 1 < leaves.size() ? &leaves[l + 1] : nullptr);
  for (LevelLeaves& level : leaves) level.follow_p();
  for (int done = 0; done < how.most;) {
    context.check();
    for (LevelLeaves& level : leaves) level.look_ahead(how.balance);
    for (LevelLeaves& level : leaves) level.follow_u();
    for (LevelLeaves& level : leaves) level.sweep(how.balance);
    for (LevelLeaves& level : leaves) level.follow_p();
    if (++done % how.check_every == 0 && ends(done)) break;
  }
  for (Level& level : levels) level.held.clear();
}

}  // namespace soapfilm
