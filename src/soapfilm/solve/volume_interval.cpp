#include "soapfilm/solve/volume_interval.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

namespace {

/// Prices of volume, in units of lambda: large ones bound large eps, small ones small eps.
constexpr std::array<double, 7> prices{0.025, 0.05, 0.1, 0.2, 0.35, 0.75, 1.5};
constexpr size_t bricks_per_task = 64;

double magnitude(double dual, double lambda) { return std::max(std::abs(dual), 1000 * lambda); }

/// Set bits and their neighbors along the axes, within the bricks of the grid.
std::vector<BrickBits> grown(const BrickGrid& grid, const std::vector<BrickBits>& bits, const Context& context) {
  std::vector<BrickBits> more(bits.size());
  parallel_for(context, bits.size(), bricks_per_task, [&](size_t b) {
    BrickBits own = bits[b];
    for (int k = 0; k < brick_volume; ++k) {
      const Vec3i at{k % brick_side, k / brick_side % brick_side, k / brick_area};
      if (own.test(at.x, at.y, at.z)) continue;
      for (int side = 0; side < 6; ++side) {
        Vec3i v = at;
        v[side / 2] += side % 2 ? 1 : -1;
        const bool within = v[side / 2] >= 0 && v[side / 2] < brick_side;
        const int32_t n =
            within ? static_cast<int32_t>(b) : grid.neighbors(b)[side % 2 ? slot_up[side / 2] : slot_down[side / 2]];
        if (n < 0 || !bits[static_cast<size_t>(n)].test(v.x & 7, v.y & 7, v.z & 7)) continue;
        own.set(k);
        break;
      }
    }
    more[b] = own;
  });
  return more;
}

class Interval {
 public:
  Interval(Level& level, const VolumeIntervalSetup& setup, const PrimalDualParams& params, const Context& context)
      : level_(level),
        setup_(setup),
        params_(params),
        context_(context),
        f_(level.grid, pages_of(context)),
        inside_(bits_above(level, setup.threshold, context)),
        near_(LabelView(level, inside_).interfaces(context)) {
    for (int step = 0; step < interval_reach; ++step) near_ = grown(level.grid, near_, context);
    parallel_for(context, near_.size(), bricks_per_task, [&](size_t b) {
      const FreeRange free = free_range(level.box, level.grid.coord(b));
      free.for_each_fixed({0, 0, 0}, brick_side, [&](int x, int y, int z) { near_[b].clear(brick_offset(x, y, z)); });
    });
    count();
    for (size_t b = 0; b < level.grid.size(); ++b)
      for (int k = 0; k < brick_volume; ++k) hold_ = std::max(hold_, std::abs(static_cast<double>(level.data(b)[k])));
    hold_ += 8 * level.lambda;
  }

  VolumeInterval find() {
    const Field<float>* const f = level_.f;
    const std::vector<int32_t> f_brick = level_.f_brick;
    found_.epsilon = setup_.epsilon;
    found_.least = held_inside_;
    found_.most = held_inside_ + near_count_;
    const double eps = setup_.epsilon * magnitude(setup_.energy, level_.lambda);
    for (const int sign : {1, -1}) {
      int worse = 0;
      for (size_t k = 0; k < prices.size() && worse < 2; ++k) {
        const double s = sign * prices[k] * level_.lambda;
        level_.f = f, level_.f_brick = f_brick;
        const Shift shift = shift_data(s);
        const double bound = (setup_.energy + eps - dual(eps) - shift.held + shift.rounding) / s;
        const double volume = bound + held_inside_;
        double& best = sign > 0 ? found_.most : found_.least;
        const bool better = sign > 0 ? volume < best : volume > best;
        worse = better ? 0 : worse + 1;
        if (better) best = volume;
        context_.progress().advance(++found_.solves / (2.0 * prices.size()), "volumes");
      }
    }
    level_.f = f, level_.f_brick = f_brick;
    parallel_for(context_, inside_.size(), bricks_per_task, [&](size_t b) {
      float* u = level_.u.brick(b);
      std::fill_n(u, brick_volume, 0.0f);
      inside_[b].for_each([&](int k) { u[k] = 1; });
    });
    return found_;
  }

 private:
  void count() {
    const double all = static_cast<double>(count_inside(level_, inside_));
    double near = 0, near_inside = 0;
    for (size_t b = 0; b < near_.size(); ++b) {
      BrickBits both = near_[b];
      near += static_cast<double>(both.count());
      both &= inside_[b];
      near_inside += static_cast<double>(both.count());
    }
    near_count_ = near;
    held_inside_ = all - near_inside;
    found_.segmented = all;
  }

  /// What the energy of a segmentation changes by in addition to - s V.
  struct Shift {
    double held = 0;      ///< sum of what f grew by at vertices that are held inside
    double rounding = 0;  ///< at most so much more: f + s is rounded
    void operator+=(const Shift& other) { held += other.held, rounding += other.rounding; }
  };

  /// The level's f becomes f + s near the interface; elsewhere it holds the side.
  Shift shift_data(double s) {
    const Shift shift = ordered_sum<Shift>(level_.grid, context_, [&](size_t b) {
      const FreeRange free = free_range(level_.box, level_.grid.coord(b));
      const float* data = level_.data(b);
      Shift of_brick;
      for (int k = 0; k < brick_volume; ++k) {
        const int x = k % brick_side, y = k / brick_side % brick_side, z = k / brick_area;
        const bool near = near_[b].test(x, y, z), inside = inside_[b].test(x, y, z);
        const double wanted = data[k] + (near ? s : inside ? hold_ : -hold_);
        const auto stored = static_cast<float>(wanted);
        f_.brick(b)[k] = stored;
        if (near)
          of_brick.rounding += std::max(0.0, wanted - stored);
        else if (inside && free.contains(x, y, z))
          of_brick.held += static_cast<double>(stored) - data[k];
      }
      return of_brick;
    });
    level_.f = &f_;
    level_.f_brick.resize(level_.grid.size());
    std::iota(level_.f_brick.begin(), level_.f_brick.end(), 0);
    return shift;
  }

  /// A lower bound of the energy of the level as it is, some hundredths of eps below its minimum.
  double dual(double eps) {
    constexpr double share = 0.05;  // of eps
    PrimalDualParams params = params_;
    const double scale = magnitude(evaluate_energy(level_, {}, context_).dual, level_.lambda);
    params.tolerance = std::max(1e-9, share * eps / scale);
    params.max_iterations = std::max(params.max_iterations, 2000);
    PrimalDualRun run;
    run.late = true;
    run.stalls = true;
    solve_primal_dual(level_, params, context_, run);
    return evaluate_energy(level_, {.threshold = {}, .certify = true}, context_).dual;
  }

  Level& level_;
  const VolumeIntervalSetup& setup_;
  const PrimalDualParams& params_;
  const Context& context_;
  Field<float> f_;                 ///< on all bricks of the grid
  std::vector<BrickBits> inside_;  ///< of the solution
  std::vector<BrickBits> near_;    ///< free vertices that may change their side
  double near_count_ = 0, held_inside_ = 0;
  double hold_ = 0;  ///< a price that no saved area pays: what is not near the interface keeps its side
  VolumeInterval found_;
};

}  // namespace

VolumeInterval find_volume_interval(Level& level, const VolumeIntervalSetup& setup, const PrimalDualParams& params,
                                    const Context& context) {
  return Interval(level, setup, params, context).find();
}

}  // namespace soapfilm
