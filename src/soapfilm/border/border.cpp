#include "soapfilm/border/border.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "soapfilm/border/closing.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/portable_math.h"
#include "soapfilm/error.h"
#include "soapfilm/grid/ordered_sum.h"

namespace soapfilm {

namespace {

/// A coarse level is solved roughly, and a second time where that leaves the choice open.
constexpr double trial_tolerance = 3e-3;
constexpr int trial_iterations = 128, more_iterations = 400;  // per level

/// As a share of a surface's cost of area: the trials are no more accurate.
constexpr double little = 0.05;
/// If a larger share of the closed surface is there only to close it, it is the back of a sheet.
constexpr double mostly_closing = 0.4, half = 0.5;

/// The level whose cells are nearest to four default voxels or, where samples are farther apart than two voxels, twice
/// their spacing: the minimal surface between samples costs there what it costs on finer levels. So it is the same
/// scale of the scene where a larger voxel was asked for. Where a smaller one was, it is level 2 nevertheless: f
/// reaches three voxels to each side of the samples, and in larger cells what is before them and what is behind cancel
/// out.
int trial_level(const BorderProblem& problem) {
  const double by_scale = portable_log2(4 * problem.default_voxel / problem.lattice.voxel);
  constexpr double coarsest = 2;
  int level = static_cast<int>(std::lround(std::clamp(by_scale, 0.0, coarsest)));
  for (double here = std::ldexp(problem.density, 2 * (level - 1)); here < 1 && level < 5; here *= 4) ++level;
  return std::min(level, problem.lattice.levels - 1);
}

/// Most objects are clearly surrounded by air. A coarser level shows that too, if it is fine enough.
bool has_coarser_trial(const Lattice& lattice, int level) {
  constexpr int fine_enough = 48;  // vertices along the longest side
  const Vec3i n = lattice.size;
  return level + 1 < lattice.levels && std::max({n.x, n.y, n.z}) >> (level + 1) >= fine_enough;
}

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

/// The result with one border; energies and costs are those of its level.
struct Trial {
  double energy = 0;     ///< lowest found; at most E(0) = 0
  double bound = 0;      ///< no u has a lower energy
  double area_cost = 0;  ///< lambda TV(u), at least 1000 lambda
  double flux = 0;       ///< through the border
  double closing = 0;    ///< share of the surface's area that is there only to close it
  int level = 0;

  /// A lower bound of the energy with any border: another border can gain at most all of the flux of p through the
  /// border of a closed problem.
  double bound_of_any() const { return bound - flux; }
};

/// E(u) where `complement` is the solution u' = 1 - u of the negated data: its energy is E(u) + sum(f). The sum is zero
/// for the divergence of directions alone, not for further evidence linear in u.
Trial of_original(Trial complement, const SupportField& field, const Context& context) {
  const auto sum = ordered_sum<double>(field.grid, context, [&](size_t b) {
    const float* f = field.f.brick(b);
    return std::accumulate(f, f + brick_volume, 0.0);
  });
  complement.energy -= sum;
  complement.bound -= sum;
  return complement;
}

Trial solve(const BorderProblem& problem, Border border, int at, PrimalDualParams solver, const Context& context) {
  solver.tolerance = std::max(solver.tolerance, trial_tolerance);
  Lattice lattice = problem.lattice;
  lattice.open = border == Border::open;
  BorderFlux flux;
  PyramidObserver observe;
  double closing = 0;
  if (!lattice.open)
    observe.solved = [&](const Level& level, const Lattice&) {
      flux.add(level);
      // Done here, as the level's data does not outlive the solve.
      closing = closing_share(level, problem.density * face_area(level.box.level), context);
    };
  const PyramidSolution solution =
      solve_coarse_levels(lattice, problem.field, problem.lambda, {at, solver, problem.norm}, context, observe);
  context.check();
  const Energies& energies = solution.reports.back().energies;
  const double lambda = solution.finest.lambda;
  Trial trial;
  trial.energy = std::min(0.0, energies.primal);
  trial.bound = std::min(trial.energy, energies.dual);
  trial.area_cost = std::max(energies.primal < 0 ? lambda * energies.total_variation : 0, 1000 * lambda);
  trial.flux = flux.sum();
  trial.level = solution.finest.box.level;
  trial.closing = closing;
  return trial;
}

std::string percent(double share) {
  return share >= 0.1 ? fmt::format("{:.0f} %", 100 * share) : fmt::format("{:.2g} %", 100 * share);
}

/// What an open surface would save, as shares of a closed surface's cost of area.
struct Saving {
  double at_least, at_most;
  double width() const { return at_most - at_least; }
};

std::string reason_of_closed(bool solid, double over_other, const Saving& spared) {
  const char* other = solid ? "air" : "solid matter";
  const std::string closed = over_other > little ? fmt::format("which costs less than {} by {} of the surface's area",
                                                               other, percent(over_other))
                                                 : fmt::format("though {} would be as good", other);
  if (spared.at_most < little) return closed + "; an open surface would save nothing";
  if (spared.at_most - spared.at_least < little)
    return fmt::format("{}; an open surface would save {}", closed, percent(spared.at_least));
  return fmt::format("{}; an open surface would save at most {}", closed, percent(spared.at_most));
}

class Choice {
 public:
  Choice(const BorderParams& params, const Trial& air, const Trial& solid, const Surroundings& scanners)
      : open_gain_(params.open_gain), air_(air), solid_(solid), scanners_(scanners) {
    // What surrounds the scanners is no object, so solid matter is preferred where both fit.
    const double tie = (scanners.stand_among_samples() ? -little : little) * solid.area_cost;
    is_solid_ = solid.energy < air.energy - tie;
    // Of two surfaces that are mostly invented neither is more likely to begin with.
    if (std::min(air.closing, solid.closing) > half) is_solid_ = solid.energy < air.energy;
  }

  const Trial& closed() const { return is_solid_ ? solid_ : air_; }

  Saving saving_of(double energy, double bound) const {
    const auto share = [&](double e) { return std::max(0.0, (closed().energy - e) / closed().area_cost); };
    return {share(energy), share(bound)};
  }
  bool under_open_sky(const Saving& spared) const { return scanners_.under_open_sky() && spared.at_most > little; }
  /// For a small sheet, the way to the border costs an open surface as much as it saves.
  bool is_sheet(const Saving& spared) const { return closed().closing > mostly_closing && spared.at_least > little; }
  /// More of the closed surface is invented than seen, as behind the walls of a room: it is solved closed, since ways
  /// to the border save nothing, and cut open afterwards.
  bool mostly_invented() const { return closed().closing > half; }
  bool undecided(const Saving& spared) const {
    if (under_open_sky(spared) || is_sheet(spared)) return false;
    const double asked = closed().closing > mostly_closing ? little : open_gain_;
    return spared.at_least <= asked && spared.at_most > asked;
  }

  void tell(const Saving& spared, BorderReport& report) const {
    report.area_cost = closed().area_cost;
    report.closing = closed().closing;
    report.chosen = Border::open;
    report.ends = true;
    if (const double middle = spared.at_least + spared.width() / 2;
        spared.at_least > open_gain_ || (spared.width() < 2 * little && middle > open_gain_)) {
      report.reason = fmt::format("which saves {} of a closed surface's area", percent(middle));
    } else if (under_open_sky(spared)) {
      report.reason = fmt::format("the scanners stand among the samples and see none in {} of the directions",
                                  percent(1 - scanners_.covered));
    } else if (is_sheet(spared)) {
      report.reason = fmt::format("for {} of a closed surface would only close it", percent(closed().closing));
    } else {
      report.chosen = is_solid_ ? Border::solid : Border::air;
      const double other = is_solid_ ? air_.energy : solid_.energy;
      report.reason = reason_of_closed(is_solid_, (other - closed().energy) / closed().area_cost, spared);
      report.ends = mostly_invented();
      if (report.ends)
        report.reason += fmt::format("; {} of it would only close it, and is cut off", percent(closed().closing));
    }
  }

 private:
  double open_gain_;
  const Trial &air_, &solid_;
  const Surroundings& scanners_;
  bool is_solid_;
};

/// The choice by the trials of one level.
BorderReport choose_at(int level, const BorderProblem& problem, const Surroundings& scanners,
                       const BorderParams& params, PrimalDualParams solver, const Context& context) {
  const int asked_iterations = solver.max_iterations;
  solver.max_iterations = std::min(asked_iterations, trial_iterations);
  BorderReport report;
  report.scanners = scanners;
  const Trial air = solve(problem, Border::air, level, solver, context);
  report.level = air.level;
  report.air = air.energy;
  report.area_cost = air.area_cost;
  report.closing = air.closing;
  report.border_flux = air.flux / air.area_cost;
  const double most = (air.energy - air.bound_of_any()) / air.area_cost;
  if (most < little) {
    report.reason = fmt::format("anything else could save no more than {} of the surface's area", percent(most));
    return report;
  }
  negate(problem.field, context);
  const Trial complement = solve(problem, Border::solid, level, solver, context);
  negate(problem.field, context);
  const Trial solid = of_original(complement, problem.field, context);
  const Choice choice(params, air, solid, report.scanners);
  // A closed surface is an open one, too.
  const double closed = std::min(air.energy, solid.energy);
  const double closed_bound = std::max(air.bound_of_any(), solid.bound_of_any());
  Saving spared = choice.saving_of(closed, closed_bound);
  report.open = closed;
  report.open_bound = closed_bound;
  for (const int iterations : {trial_iterations, more_iterations}) {
    if (!choice.undecided(spared) && iterations == more_iterations) break;
    solver.max_iterations = std::min(asked_iterations, iterations);
    const Trial open = solve(problem, Border::open, level, solver, context);
    report.open = std::min(*report.open, open.energy);
    report.open_bound = std::max(*report.open_bound, open.bound);
    spared = choice.saving_of(*report.open, *report.open_bound);
  }
  report.solid = solid.energy;
  choice.tell(spared, report);
  return report;
}

/// Clearly air: solid matter would cost much more, an open surface save nothing.
bool is_clear(const BorderReport& report) {
  constexpr double much = 0.5;  // of the surface's cost of area
  if (report.chosen != Border::air) return false;
  if (!report.solid) return true;
  return *report.solid - *report.air > much * report.area_cost &&
         *report.air - *report.open_bound < little * report.area_cost;
}

}  // namespace

void validate(const BorderParams& params) {
  if (!(params.open_gain > 0 && params.open_gain <= 1))
    throw ParameterError(fmt::format("open_gain = {:g}, must be > 0 and <= 1", params.open_gain));
}

void negate(SupportField& field, const Context& context) {
  parallel_for(context, field.grid.size(), 256, [&](size_t b) {
    float* f = field.f.brick(b);
    for (int i = 0; i < brick_volume; ++i) f[i] = -f[i];
  });
}

BorderReport choose_border(const BorderProblem& problem, const Surroundings& scanners, const BorderParams& params,
                           PrimalDualParams solver, const Context& context) {
  const int level = trial_level(problem);
  if (has_coarser_trial(problem.lattice, level)) {
    BorderReport coarser = choose_at(level + 1, problem, scanners, params, solver, context);
    if (is_clear(coarser)) return coarser;
  }
  return choose_at(level, problem, scanners, params, solver, context);
}

}  // namespace soapfilm
