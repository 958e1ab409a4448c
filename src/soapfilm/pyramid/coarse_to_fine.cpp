#include "soapfilm/pyramid/coarse_to_fine.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"

namespace soapfilm {

namespace {

constexpr int max_growths = 8;
constexpr double share_left_out = 0.1;  // of the gap's tolerance, for data that the finest band leaves out

/// The whole box, without a band: where the pyramid starts.
Level whole_level(const LevelBox& box, const SupportField& support, double lambda, Norm norm,
                  const Parallel& parallel) {
  BrickMask everywhere(box.bricks);
  everywhere.fill(true);
  const auto scale = static_cast<double>(size_t{1} << (2 * box.level));
  return make_level(box, static_cast<float>(lambda * scale), everywhere, support.grid, support.f, parallel, norm);
}

/// An upper bound of what any surface can gain from a level's data: the sum of its positive part.
double largest_gain(const SupportField& support) {
  double sum = 0;
  for (size_t b = 0; b < support.grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i) sum += std::max(0.0f, support.f.brick(b)[i]);
  return sum;
}

/// The coarsest level whose data still pays for the surface's area. f is a dipole some six fine voxels wide; in cells
/// wider than that its two sides cancel, and a level that sees no surface would leave the finer ones a band without an
/// inside. The area follows from the bricks that the samples reach: a surface reaches one per 20 voxel^2.
int start_level(const Lattice& lattice, const std::vector<const SupportField*>& data, double lambda, Norm norm) {
  constexpr double area_per_brick = 20;
  constexpr double gain_per_cost = 1.5;
  constexpr int paper_start = 2;  // section 4.3: a three-level pyramid
  const double cost = lambda * mean_area(norm) * area_per_brick * static_cast<double>(data[0]->grid.size());
  int level = lattice.levels - 1;
  while (level > paper_start && largest_gain(*data[static_cast<size_t>(level)]) < gain_per_cost * cost) --level;
  return level;
}

}  // namespace

PyramidSolution solve_coarse_to_fine(const Lattice& lattice, const SupportField& support, double lambda,
                                     const PrimalDualParams& params, const Parallel& parallel, Progress& progress,
                                     Norm norm, const PyramidObserver& observe) {
  std::vector<SupportField> coarser;  // data terms of levels 1, 2, ...
  coarser.reserve(static_cast<size_t>(lattice.levels));
  for (int l = 1; l < lattice.levels; ++l)
    coarser.push_back(restrict_field(l == 1 ? support : coarser.back(), lattice.box(l), parallel));
  std::vector<const SupportField*> data = {&support};
  for (const SupportField& field : coarser) data.push_back(&field);
  const int start = start_level(lattice, data, lambda, norm);

  PyramidSolution solution;
  Level level;
  for (int l = start; l >= 0; --l) {
    const LevelBox box = lattice.box(l);
    const SupportField& field = *data[static_cast<size_t>(l)];
    const Level coarse = std::exchange(level, Level{});
    BrickMask band;
    if (l == start) {
      level = whole_level(box, field, lambda, norm, parallel);
    } else {
      coarser.erase(coarser.begin() + l, coarser.end());  // its work is done: nobody reads coarse.data() from here
      const double scale = std::max(std::abs(solution.reports.back().energies.dual), 1000 * lambda);
      band = choose_band(coarse, box, field, share_left_out * params.tolerance * scale, parallel);
      level = prolong_level(coarse, box, band, field, parallel);
    }

    LevelReport report;
    report.level = l;
    for (;;) {
      const PrimalDualReport solved =
          solve_primal_dual(level, params, parallel, progress, [&](int iterations, const Energies& e) {
            progress.advance(1.0 - static_cast<double>(l) / (start + 1),
                             fmt::format("level {}, {} iterations, gap {:.1e}", l, report.iterations + iterations,
                                         e.relative_gap(level.lambda)));
            if (observe.evaluated) observe.evaluated(level, report.iterations + iterations, e);
          });
      report.iterations += solved.iterations;
      report.converged = solved.converged;
      report.energies = solved.energies;
      if (l == start || report.band_growths == max_growths) break;
      const BrickMask grown = growth(level, coarse);
      if (grown.count() == 0) break;
      band |= grown;
      level = prolong_level(coarse, box, band, field, parallel, &level);
      ++report.band_growths;
    }
    report.active_vertices = level.grid.vertices();
    if (observe.solved) observe.solved(level, lattice.of_level(l));
    solution.reports.push_back(report);
  }
  solution.finest = std::move(level);
  return solution;
}

}  // namespace soapfilm
