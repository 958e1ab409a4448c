#include "soapfilm/pyramid/coarse_to_fine.h"

#include <fmt/core.h>

#include <utility>

#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"

namespace soapfilm {

namespace {

constexpr int max_growths = 8;

Level coarsest_level(const Lattice& lattice, const SupportField& support, double lambda, const Parallel& parallel) {
  const LevelBox box = lattice.box(lattice.levels - 1);
  BrickMask everywhere(box.bricks);
  everywhere.fill(true);
  const auto scale = static_cast<double>(size_t{1} << (2 * box.level));
  return make_level(box, static_cast<float>(lambda * scale), everywhere, support.grid, support.f, parallel);
}

BrickMask support_bricks(const SupportField& support, Vec3i bricks) {
  BrickMask mask(bricks);
  for (size_t b = 0; b < support.grid.size(); ++b) mask.set(support.grid.coord(b));
  return mask;
}

}  // namespace

PyramidSolution solve_coarse_to_fine(const Lattice& lattice, const SupportField& support, double lambda,
                                     const PrimalDualParams& params, const Parallel& parallel, Progress& progress) {
  std::vector<SupportField> coarser;  // data terms of levels 1, 2, ...
  coarser.reserve(static_cast<size_t>(lattice.levels));
  for (int l = 1; l < lattice.levels; ++l)
    coarser.push_back(restrict_field(l == 1 ? support : coarser.back(), lattice.box(l), parallel));
  const auto data = [&](int l) -> const SupportField& {
    return l == 0 ? support : coarser[static_cast<size_t>(l) - 1];
  };

  PyramidSolution solution;
  Level level;
  for (int l = lattice.levels - 1; l >= 0; --l) {
    const LevelBox box = lattice.box(l);
    const Level coarse = std::exchange(level, Level{});
    BrickMask band;
    if (l == lattice.levels - 1) {
      level = coarsest_level(lattice, data(l), lambda, parallel);
    } else {
      band = interface_children(coarse, box.bricks, parallel);
      band |= support_bricks(data(l), box.bricks);
      level = prolong_level(coarse, box, band, data(l), parallel);
    }

    LevelReport report;
    report.level = l;
    for (;;) {
      const PrimalDualReport solved =
          solve_primal_dual(level, params, parallel, progress, [&](int iterations, const Energies& e) {
            progress.advance(1.0 - static_cast<double>(l) / lattice.levels,
                             fmt::format("level {}, {} iterations, gap {:.1e}", l, report.iterations + iterations,
                                         e.relative_gap(level.lambda)));
          });
      report.iterations += solved.iterations;
      report.converged = solved.converged;
      report.energies = solved.energies;
      if (l == lattice.levels - 1 || report.band_growths == max_growths) break;
      const BrickMask grown = growth(level, coarse);
      if (grown.count() == 0) break;
      band |= grown;
      level = prolong_level(coarse, box, band, data(l), parallel, &level);
      ++report.band_growths;
    }
    report.active_vertices = level.grid.vertices();
    solution.reports.push_back(report);
  }
  solution.finest = std::move(level);
  return solution;
}

}  // namespace soapfilm
