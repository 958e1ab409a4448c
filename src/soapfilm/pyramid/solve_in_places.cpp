#include "soapfilm/pyramid/solve_in_places.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict_level.h"

namespace soapfilm {

namespace {

/// How long a level is solved: so many iterations, and more after each growth of its band. What takes longer are films
/// between sparse samples, which wander away from what the samples say.
struct Patience {
  int first, after_growth, growths;
};

/// Runs the iteration, and again whenever grow(the bricks that the band needs) has made the band larger.
template <class Needed, class Grow>
void solve(Level& level, PrimalDualParams params, const Patience& patience, const Context& context, LevelReport& report,
           Needed&& needed, Grow&& grow) {
  PrimalDualRun run;
  run.late = run.stalls = run.settles = true;
  run.checked = [&](int iterations, double gap) {
    context.progress().advance(0, fmt::format("{} iterations, gap {:.1e}", report.iterations + iterations, gap));
  };
  report.tolerance = params.tolerance;
  const int most = params.max_iterations;
  int now = patience.first;
  while (level.grid.size() > 0 && report.iterations < most) {
    report.active_vertices = level.grid.vertices();
    params.max_iterations = std::min(now, most - report.iterations);
    const PrimalDualReport solved = solve_primal_dual(level, params, context, run);
    report.iterations += solved.iterations;
    report.converged = solved.converged;
    report.stop = solved.stop;
    report.energies = solved.energies;
    const BrickMask grown = needed();
    if (grown.count() == 0 || report.band_growths == patience.growths) return;
    grow(grown);
    ++report.band_growths;
    now = patience.after_growth;
  }
}

/// The data of a level in places, and where there are none, or where the places end, a strong pull to the sides that
/// its u has now: those of the coarser level. A film that spans samples has nothing to gain from finer voxels; between
/// fluxes that are fixed, and known as well as the coarser level was solved, it would turn to where they let it.
class Pull {
 public:
  /// `free`: the bricks without the pull.
  Pull(const SupportField& support, BrickMask free) : support_(support), free_(std::move(free)) {}

  /// The level refers to this data from here on.
  void on(Level& level, const Context& context) {
    BrickMask bricks(level.box.bricks);
    add_bricks(support_.grid, bricks);
    for (size_t b = 0; b < level.grid.size(); ++b)
      if (pulls(level, level.grid.coord(b))) bricks.set(level.grid.coord(b));
    field_.grid = BrickGrid(bricks, context);
    field_.f = Field<float>(field_.grid, pages_of(context));
    parallel_for(context, field_.grid.size(), 64, [&](size_t k) {
      const Vec3i at = field_.grid.coord(k);
      const int32_t own = support_.grid.find(at), b = level.grid.find(at);
      float* f = field_.f.brick(k);
      if (b >= 0 && pulls(level, at)) {
        const float* u = level.u.brick(static_cast<size_t>(b));
        for (int i = 0; i < brick_volume; ++i) f[i] = u[i] > 0.5f ? level.lambda : -level.lambda;
      } else if (own >= 0) {
        std::copy_n(support_.f.brick(static_cast<size_t>(own)), brick_volume, f);
      }
    });
    refer(field_, level);
  }
  /// The level refers to the samples' data again.
  void off(Level& level) const { refer(support_, level); }

 private:
  bool pulls(const Level& level, Vec3i brick) const {
    if (!free_.test(brick)) return true;
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i beside = brick + slot_offset(slot);
      if (free_.contains(beside) && !level.covers(beside)) return true;
    }
    return false;
  }
  static void refer(const SupportField& field, Level& level) {
    level.f = &field.f;
    for (size_t b = 0; b < level.grid.size(); ++b)
      level.f_brick[b] = std::max(-1, field.grid.find(level.grid.coord(b)));
  }

  const SupportField& support_;
  BrickMask free_;
  SupportField field_;
};

/// Takes u and p of these bricks from another state of the level, but not at the border of its box: that of a lattice
/// that begins with this level may be another one.
void take(const Level& from, const BrickMask& bricks, Level& level, const Context& context) {
  parallel_for(context, from.grid.size(), 64, [&](size_t b) {
    const Vec3i at = from.grid.coord(b);
    if (!bricks.contains(at) || !bricks.test(at) || at_border(level.box, at)) return;
    const auto n = static_cast<size_t>(level.grid.find(at));
    std::copy_n(from.u.brick(b), brick_volume, level.u.brick(n));
    std::copy_n(from.p.brick(b), 3 * brick_volume, level.p.brick(n));
  });
}

}  // namespace

Level solve_in_places(const Level& coarse, const LevelBox& box, std::shared_ptr<const BrickMask> places,
                      const SupportField& support, const PrimalDualParams& params, const Context& context,
                      LevelReport& report) {
  constexpr Patience patience{64, 32, 6};
  BrickMask band = choose_band_in(*places, coarse, box, support, context);
  BrickMask data(box.bricks);
  add_bricks(support.grid, data);
  Pull pull(support, with_neighbors(data));
  const auto prolonged = [&](Level* previous) {
    Level level = prolong_in_places(coarse, box, band, places, support, context, previous);
    pull.on(level, context);
    return level;
  };
  Level level = prolonged(nullptr);
  solve(
      level, params, patience, context, report, [&] { return growth(level, &coarse.grid, context); },
      [&](const BrickMask& grown) {
        band |= grown;
        Level previous = std::move(level);
        level = prolonged(&previous);
      });
  pull.off(level);
  return level;
}

Level solve_coarser_in_places(const Level& fine, const Level& alone, const LevelBox& box, const BrickMask& places,
                              const SupportField& support, const PrimalDualParams& params, const Context& context,
                              LevelReport& report) {
  constexpr Patience patience{128, 32, 2};
  BrickMask band = parents_of(fine.grid, box.bricks, context);
  const auto add = [&](const BrickGrid& grid) {
    for (size_t b = 0; b < grid.size(); ++b)
      if (const Vec3i at = grid.coord(b); places.contains(at) && places.test(at)) band.set(at);
  };
  add(support.grid);
  add(alone.grid);
  const BrickMask around = with_neighbors(places);
  Pull pull(support, places);
  const auto joined = [&](const Level& state) {
    Level level = restrict_level(fine, box, band, support, context);
    take(state, places, level, context);
    level.held.resize(level.grid.size());
    for (size_t b = 0; b < level.grid.size(); ++b)
      level.held[b] = around.test(level.grid.coord(b)) ? Held::no : Held::rests;
    pull.on(level, context);
    return level;
  };
  Level level = joined(alone);
  solve(
      level, params, patience, context, report,
      [&] {
        BrickMask grown(box.bricks);
        growth(level, nullptr, context).for_each([&](Vec3i b) {
          if (places.test(b)) grown.set(b);
        });
        return grown;
      },
      [&](const BrickMask& grown) {
        band |= grown;
        level = joined(level);
      });
  pull.off(level);
  return level;
}

}  // namespace soapfilm
