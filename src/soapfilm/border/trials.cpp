#include "soapfilm/border/trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "soapfilm/border/closing.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/share.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/pyramid/restrict.h"

namespace soapfilm {

namespace {

constexpr double trial_tolerance = 3e-3;

/// The sum of |p| over the faces between the box's free and fixed vertices, of levels from coarse to fine: outside a
/// level's band the coarser level's p counts. Bricks partly in the band count twice.
class BorderFlux {
 public:
  void add(const Level& level) {
    for (const Part& part : last_)
      if (!covered(part.brick, level)) kept_ += part.flux;
    last_.clear();
    for (size_t b = 0; b < level.grid.size(); ++b)
      if (const Vec3i coord = level.grid.coord(b); at_border(level.box, coord))
        last_.push_back({coord, through_border(level, b)});
  }
  double sum() const {
    double sum = kept_;
    for (const Part& part : last_) sum += part.flux;
    return sum;
  }

 private:
  struct Part {
    Vec3i brick;
    double flux;
  };

  /// Are all children of a coarser brick that lie at the border in the band?
  static bool covered(Vec3i brick, const Level& level) {
    for (int child = 0; child < 8; ++child) {
      const Vec3i coord = brick * 2 + Vec3i{child % 2, child / 2 % 2, child / 4};
      const Vec3i n = level.box.bricks;
      if (coord.x >= n.x || coord.y >= n.y || coord.z >= n.z) continue;
      if (at_border(level.box, coord) && has_free(level.box, coord) && level.grid.find(coord) < 0) return false;
    }
    return true;
  }

  static double through_border(const Level& level, size_t b) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float* p = level.p.brick(b, axis);
      for (int i = 0; i < brick_volume; ++i) {
        const Vec3i v = level.grid.first_vertex(b) + vertex_in_brick(i);
        Vec3i next = v;
        ++next[axis];
        if (level.box.is_free(v) != level.box.is_free(next)) sum += std::abs(double{p[i]});
      }
    }
    return sum;
  }

  std::vector<Part> last_;  ///< of the previous level
  double kept_ = 0;         ///< of coarser levels, where finer ones have no band
};

double sum_of_data(const SupportField& field, const Context& context) {
  std::vector<double> terms(field.grid.size());
  share_values(terms, 256, context, [&](size_t b) {
    const float* f = field.f.brick(b);
    terms[b] = std::accumulate(f, f + brick_volume, 0.0);
  });
  return ordered_sum(field.grid, terms);
}

}  // namespace

BorderTrials::BorderTrials(const BorderProblem& problem, const Context& context)
    : problem_(problem),
      context_(context),
      coarser_(coarser_fields(problem.field, problem.lattice, problem.lattice.levels, context)),
      negated_(coarser_.size() + 1) {}

Trial BorderTrials::run(Border border, int level, const PrimalDualParams& solver) {
  if (border != Border::solid) return solve(border, level, solver);
  if (!sum_) sum_ = sum_of_data(problem_.field, alone(context_));
  Trial trial = solve(border, level, solver);
  data(0, false);
  trial.energy -= *sum_;
  trial.bound -= *sum_;
  return trial;
}

std::vector<Trial> BorderTrials::run_ahead(int level, const PrimalDualParams& solver) {
  constexpr std::array first = {Border::air, Border::solid, Border::open};
  Ranks* const ranks = ranks_of(context_);
  if (!ranks) return {};
  const auto self = static_cast<size_t>(ranks->rank());
  const size_t count = std::min(first.size(), static_cast<size_t>(ranks->count()));
  if (!sum_) sum_ = sum_of_data(problem_.field, context_);
  std::vector<Trial> found = of_all(*ranks, self < count ? run(first[self], level, solver) : Trial{});
  found.resize(count);
  return found;
}

Trial BorderTrials::solve(Border border, int level, PrimalDualParams solver) {
  solver.tolerance = std::max(solver.tolerance, trial_tolerance);
  Lattice lattice = problem_.lattice;
  lattice.open = border == Border::open;
  BorderFlux flux;
  PyramidObserver observe;
  if (!lattice.open) observe.solved = [&](const Level& solved, const Lattice&) { flux.add(solved); };
  const PyramidSolution solution = solve_coarse_levels(
      lattice, problem_.field,
      [&](int l) -> const SupportField& { return data(static_cast<size_t>(l), border == Border::solid); },
      problem_.lambda, {level, solver, problem_.norm}, context_, observe);
  context_.check();
  const Level& finest = solution.finest;
  const Energies& energies = solution.reports.back().energies;
  const double lambda = finest.lambda;
  Trial trial;
  trial.energy = std::min(0.0, energies.primal);
  trial.bound = std::min(trial.energy, energies.dual);
  trial.area_cost = std::max(energies.primal < 0 ? lambda * energies.total_variation : 0, 1000 * lambda);
  trial.flux = flux.sum();
  trial.level = finest.box.level;
  if (!lattice.open) trial.closing = closing_share(finest, problem_.density * face_area(finest.box.level), context_);
  return trial;
}

const SupportField& BorderTrials::data(size_t level, bool complement) {
  SupportField& field = level == 0 ? problem_.field : coarser_[level - 1];
  if (negated_[level] != uint8_t{complement}) negate(field, context_);
  negated_[level] = complement;
  return field;
}

}  // namespace soapfilm
