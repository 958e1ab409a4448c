#include "soapfilm/pyramid/solve_in_places.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict_level.h"

namespace soapfilm {

namespace {

/// Films between sparse samples wander for long, away from what samples say.
constexpr int most_growths = 2;
constexpr double bricks_of_films = 0.01;  // of the band, to which it does not grow

/// Runs the iteration once more, `most` times in all.
void go_on(Level& level, PrimalDualParams params, int most, const Context& context, LevelReport& report) {
  PrimalDualRun run;
  run.late = run.stalls = run.settles = true;
  run.checked = [&](int iterations, double gap) {
    context.progress().advance(0, fmt::format("{} iterations, gap {:.1e}", report.iterations + iterations, gap));
  };
  report.tolerance = params.tolerance;
  report.active_vertices = level.grid.vertices();
  params.max_iterations = std::min(params.max_iterations, most) - report.iterations;
  const PrimalDualReport solved = solve_primal_dual(level, params, context, run);
  report.iterations += solved.iterations;
  report.converged = solved.converged;
  report.stop = solved.stop;
  report.energies = solved.energies;
}

/// Whether the band is to grow by these bricks.
bool grows(const BrickMask& band, const BrickMask& grown, int most, const LevelReport& report) {
  return static_cast<double>(grown.count()) > bricks_of_films * static_cast<double>(band.count()) &&
         report.band_growths < most_growths && report.iterations < most;
}

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
  constexpr int most_iterations = 64;  // what takes more are films
  BrickMask band = choose_band_in(*places, coarse, box, support, context);
  Level level = prolong_in_places(coarse, box, band, places, support, context, nullptr);
  while (level.grid.size() > 0) {
    go_on(level, params, most_iterations, context, report);
    const BrickMask grown = growth(level, &coarse.grid, context);
    if (!grows(band, grown, most_iterations, report)) break;
    band |= grown;
    Level previous = std::move(level);
    level = prolong_in_places(coarse, box, band, places, support, context, &previous);
    ++report.band_growths;
  }
  return level;
}

Level solve_coarser_in_places(const Level& fine, const Level& alone, const LevelBox& box, const BrickMask& places,
                              const SupportField& support, const PrimalDualParams& params, const Context& context,
                              LevelReport& report) {
  constexpr int most_iterations = 128;
  BrickMask band = parents_of(fine.grid, box.bricks, context);
  const auto add = [&](const BrickGrid& grid) {
    for (size_t b = 0; b < grid.size(); ++b)
      if (const Vec3i at = grid.coord(b); places.contains(at) && places.test(at)) band.set(at);
  };
  add(support.grid);
  add(alone.grid);
  Level level;
  for (;;) {
    Level next = restrict_level(fine, box, band, support, context);
    take(level.grid.size() > 0 ? level : alone, places, next, context);
    level = std::move(next);
    level.held.resize(level.grid.size());
    for (size_t b = 0; b < level.grid.size(); ++b) level.held[b] = !places.test(level.grid.coord(b));
    go_on(level, params, most_iterations, context, report);
    BrickMask grown(box.bricks);
    growth(level, nullptr, context).for_each([&](Vec3i b) {
      if (places.test(b)) grown.set(b);
    });
    if (!grows(band, grown, most_iterations, report)) return level;
    band |= grown;
    ++report.band_growths;
  }
}

}  // namespace soapfilm
