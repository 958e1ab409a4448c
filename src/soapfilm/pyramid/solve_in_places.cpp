#include "soapfilm/pyramid/solve_in_places.h"

#include <fmt/core.h>

#include <utility>

#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"

namespace soapfilm {

Level solve_in_places(const Level& coarse, const LevelBox& box, std::shared_ptr<const BrickMask> places,
                      const SupportField& support, const PrimalDualParams& params, const Context& context,
                      LevelReport& report) {
  constexpr int max_growths = 8;
  report.level = box.level;
  report.tolerance = params.tolerance;
  BrickMask band = choose_band_in(*places, coarse, box, support, context);
  Level level = prolong_in_places(coarse, box, band, places, support, context, nullptr);
  PrimalDualRun run;
  run.late = run.stalls = true;
  run.checked = [&](int iterations, double gap) {
    context.progress().advance(0, fmt::format("{} iterations, gap {:.1e}", report.iterations + iterations, gap));
  };
  while (level.grid.size() > 0) {
    report.active_vertices = level.grid.vertices();
    PrimalDualParams left = params;
    left.max_iterations -= report.iterations;
    const PrimalDualReport solved = solve_primal_dual(level, left, context, run);
    report.iterations += solved.iterations;
    report.converged = solved.converged;
    report.stop = solved.stop;
    report.energies = solved.energies;
    const BrickMask grown = growth(level, &coarse.grid, context);
    if (grown.count() == 0 || report.band_growths == max_growths || report.iterations >= params.max_iterations) break;
    band |= grown;
    Level previous = std::move(level);
    level = prolong_in_places(coarse, box, band, places, support, context, &previous);
    ++report.band_growths;
  }
  return level;
}

}  // namespace soapfilm
