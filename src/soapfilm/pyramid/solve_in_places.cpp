#include "soapfilm/pyramid/solve_in_places.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"

namespace soapfilm {

Level solve_in_places(const Level& coarse, const LevelBox& box, std::shared_ptr<const BrickMask> places,
                      const SupportField& support, const PrimalDualParams& params, const Context& context,
                      LevelReport& report) {
  // Films between sparse samples wander for long, away from what samples say: they are the coarser level's.
  constexpr int max_growths = 2, most_iterations = 64;
  constexpr double few_bricks = 0.01;  // of the band, to which it does not grow
  report.level = box.level;
  report.tolerance = params.tolerance;
  BrickMask band = choose_band_in(*places, coarse, box, support, context);
  Level level = prolong_in_places(coarse, box, band, places, support, context, nullptr);
  PrimalDualRun run;
  run.late = run.stalls = run.settles = true;
  run.checked = [&](int iterations, double gap) {
    context.progress().advance(0, fmt::format("{} iterations, gap {:.1e}", report.iterations + iterations, gap));
  };
  while (level.grid.size() > 0) {
    report.active_vertices = level.grid.vertices();
    PrimalDualParams left = params;
    left.max_iterations = std::min(params.max_iterations, most_iterations) - report.iterations;
    const PrimalDualReport solved = solve_primal_dual(level, left, context, run);
    report.iterations += solved.iterations;
    report.converged = solved.converged;
    report.stop = solved.stop;
    report.energies = solved.energies;
    const BrickMask grown = growth(level, &coarse.grid, context);
    const double few = few_bricks * static_cast<double>(band.count());
    if (static_cast<double>(grown.count()) <= few || report.band_growths == max_growths ||
        report.iterations >= std::min(params.max_iterations, most_iterations))
      break;
    band |= grown;
    Level previous = std::move(level);
    level = prolong_in_places(coarse, box, band, places, support, context, &previous);
    ++report.band_growths;
  }
  return level;
}

}  // namespace soapfilm
