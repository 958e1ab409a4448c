#include "soapfilm/border/border.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "soapfilm/border/trials.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/portable_math.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

/// A coarse level is solved roughly, and a second time where that leaves the choice open.
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
BorderReport choose_at(int level, BorderTrials& trials, const Surroundings& scanners, const BorderParams& params,
                       PrimalDualParams solver) {
  const int asked_iterations = solver.max_iterations;
  solver.max_iterations = std::min(asked_iterations, trial_iterations);
  const std::vector<Trial> ahead = trials.run_ahead(level, solver);
  const auto trial = [&](size_t k, Border border) {
    return k < ahead.size() ? ahead[k] : trials.run(border, level, solver);
  };
  BorderReport report;
  report.scanners = scanners;
  const Trial air = trial(0, Border::air);
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
  const Trial solid = trial(1, Border::solid);
  const Choice choice(params, air, solid, report.scanners);
  // A closed surface is an open one, too.
  const double closed = std::min(air.energy, solid.energy);
  const double closed_bound = std::max(air.bound_of_any(), solid.bound_of_any());
  Saving spared = choice.saving_of(closed, closed_bound);
  report.open = closed;
  report.open_bound = closed_bound;
  const auto compare = [&](const Trial& open) {
    report.open = std::min(*report.open, open.energy);
    report.open_bound = std::max(*report.open_bound, open.bound);
    spared = choice.saving_of(*report.open, *report.open_bound);
  };
  compare(trial(2, Border::open));
  if (choice.undecided(spared)) {
    solver.max_iterations = std::min(asked_iterations, more_iterations);
    compare(trials.run(Border::open, level, solver));
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
  BorderTrials trials(problem, context);
  if (has_coarser_trial(problem.lattice, level)) {
    BorderReport coarser = choose_at(level + 1, trials, scanners, params, solver);
    if (is_clear(coarser)) return coarser;
  }
  return choose_at(level, trials, scanners, params, solver);
}

}  // namespace soapfilm
