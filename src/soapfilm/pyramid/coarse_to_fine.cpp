#include "soapfilm/pyramid/coarse_to_fine.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"

namespace soapfilm {

namespace {

constexpr int max_growths = 8;
constexpr int patience = 128;           // iterations; wide enough bands take 16 to 112
constexpr double share_left_out = 0.1;  // of the gap's tolerance, for data that the finest band leaves out
/// A level without a band has at most so many times the bricks of its data. Hollows between samples should be in there,
/// and what an open border leaves inside; if they are not, it is solved again on more.
constexpr double most_bricks = 16, more_bricks = 8;
constexpr double few_bricks = 0.01;  // of the band, to which the finest open level does not grow

/// The tolerance of a level. The two finest take almost all of the time. The finest has the tolerance itself:
/// thresholding leaves a gap of its own, about 1 % on raw scans. From the next level it takes as many iterations, and
/// ends at the same gap, whether that has this gap or twice as much; the data that its band leaves out keeps the
/// coarser gap. Coarser levels cost little, and where samples are missing they alone decide: over a hole, a surface
/// that they leave before it is in place stays there.
double tolerance_of(int level, int start, double tolerance) {
  constexpr double next_to_finest = 2, coarse_tolerance = 3e-4;
  constexpr double rough = 1e-2;  // of levels that only give a start
  if (level > start) return rough;
  if (level == 0) return tolerance;
  return level == 1 && level < start ? next_to_finest * tolerance : std::min(tolerance, coarse_tolerance);
}

/// How much work, vertices times iterations, a coarse level of an open surface may take, in units of the finest
/// level's: the vertices of its data times usual_iterations. Across wide gaps films are nearly as good in many places:
/// a coarse level would look for the best one for longer than all others take together, and the finer ones move them
/// anyway.
double most_work(int level) {
  constexpr double next_to_finest = 2, coarse = 0.5;
  return level == 1 ? next_to_finest : coarse;
}
constexpr int usual_iterations = 128;
constexpr int least_iterations = 32;  // on a band that has just grown

/// sigma in units of the given parameter's. Where flux that was reduced (flux_kept()) must be restored, and the band is
/// wide enough for it, larger steps of p save some iterations; elsewhere they cost some.
double balance_of(int level, int start) { return level > 1 && level < start ? 1.4 : 1.0; }

/// An upper bound of what any surface can gain from a level's data: the sum of its positive part.
double largest_gain(const SupportField& support, const Context& context) {
  return ordered_sum<double>(support.grid, context, [&](size_t b) {
    double sum = 0;
    for (int i = 0; i < brick_volume; ++i) sum += std::max(0.0f, support.f.brick(b)[i]);
    return sum;
  });
}

/// The fraction of lambda used on each level, the finest first, up to the end of the pyramid. A level uses all of
/// lambda if its data pays for the surface's area: f is a dipole about six fine voxels wide; in wider cells its two
/// sides cancel, and a level without a surface would leave the finer ones a band without an inside. The area is
/// estimated from the bricks that the samples reach: a surface reaches one per 20 voxel^2. Coarser levels use the
/// fraction that their data pays for, if there is any: they show roughly where the inside is, which from zero takes one
/// iteration per third of a vertex.
std::vector<double> lambda_shares(const LevelData& data, int levels, size_t finest_bricks, double lambda, Norm norm,
                                  const Context& context) {
  constexpr double area_per_brick = 20;
  constexpr double gain_per_cost = 1.5;
  constexpr double least_share = 0.25;
  constexpr size_t paper_levels = 3;  // section 4.3
  const double cost = lambda * mean_area(norm) * area_per_brick * static_cast<double>(finest_bricks);
  std::vector<double> shares(static_cast<size_t>(levels), 1.0);
  for (size_t l = shares.size(); l-- > paper_levels;) {
    shares[l] = std::min(1.0, largest_gain(data(static_cast<int>(l)), context) / (gain_per_cost * cost));
    if (shares[l] == 1) break;
  }
  const auto end = std::find_if(shares.begin(), shares.end(), [](double share) { return share < least_share; });
  shares.erase(end, shares.end());
  return shares;
}

/// Solves from the coarsest level down.
class Descent {
 public:
  Descent(const Lattice& lattice, const SupportField& support, double lambda, const PrimalDualParams& params,
          const Context& context, Norm norm, const PyramidObserver& observe)
      : lattice_(lattice),
        support_(support),
        lambda_(lambda),
        params_(params),
        context_(context),
        norm_(norm),
        observe_(observe) {}

  /// Solves the levels down to `last`, or to the first one that uses all of lambda. Those below all of lambda are
  /// solved roughly, the others to the given tolerance.
  PyramidSolution roughly_to(int last, const LevelData& data) {
    last_ = last;
    std::vector<SupportField> freed;
    return to(last, data, freed);
  }

  /// Solves the levels down to `last`; returns that one.
  PyramidSolution to(int last) {
    std::vector<SupportField> coarser = coarser_fields(support_, lattice_, lattice_.levels, context_);
    const LevelData data = [&](int level) -> const SupportField& {
      return level == 0 ? support_ : coarser[static_cast<size_t>(level - 1)];
    };
    return to(last, data, coarser);
  }

 private:
  /// `coarser`: the data of levels 1 and on where it is freed once finer levels begin.
  PyramidSolution to(int last, const LevelData& data, std::vector<SupportField>& coarser) {
    const std::vector<double> shares =
        lambda_shares(data, lattice_.levels, support_.grid.size(), lambda_, norm_, context_);
    coarsest_ = static_cast<int>(shares.size()) - 1;
    start_ = static_cast<int>(std::count(shares.begin(), shares.end(), 1.0)) - 1;
    last = std::min(last, start_);

    PyramidSolution solution;
    Level& level = solution.finest;
    for (int l = coarsest_; l >= last; --l) {
      const SupportField& field = data(l);
      LevelReport report;
      report.level = l;
      report.lambda_share = shares[static_cast<size_t>(l)];
      if (l < start_ && !coarser.empty())
        coarser.erase(coarser.begin() + l, coarser.end());  // data(l + 1) and on is not read any more
      if (auto known = find_known(field, report)) {
        level = std::move(*known);
      } else {
        const double scale =
            solution.reports.empty() ? 0 : std::max(std::abs(solution.reports.back().energies.dual), 1000 * lambda_);
        level = l >= start_
                    ? without_band(level, field, report)
                    : solve_on_band(std::move(level), field, share_left_out * params_.tolerance * scale, report);
        report.active_vertices = level.grid.vertices();
        if (l > 0) report.binary = evaluate_energy(level, {.threshold = 0.5f, .certify = false}, context_);
        if (observe_.keep) observe_.keep(level, report);
      }
      if (observe_.solved && l <= start_) observe_.solved(level, lattice_.of_level(l));
      solution.reports.push_back(report);
    }
    return solution;
  }

  float lambda_of(const LevelReport& report) const {
    return static_cast<float>(lambda_ * report.lambda_share * face_area(report.level));
  }

  std::optional<Level> find_known(const SupportField& field, LevelReport& report) const {
    if (!observe_.known) return {};
    const auto make = [&](const BrickMask& bricks) {
      return make_level(lattice_.box(report.level), lambda_of(report), bricks, field.grid, field.f, context_, norm_);
    };
    return observe_.known(report, make);
  }

  /// A level without a band, solved from the coarser one, solved with less of lambda, if there is one: on the bricks
  /// around its data, and on more of them as long as the surface ends where they do and finer levels start from it.
  /// (The bounds of a rough solution are valid on any bricks.)
  Level without_band(const Level& coarse, const SupportField& field, LevelReport& report) const {
    const LevelBox box = lattice_.box(report.level);
    const float lambda = lambda_of(report);
    for (double most = most_bricks;; most *= more_bricks) {
      const BrickMask bricks = start_bricks(box, field.grid, most);
      begin(report.level, bricks, coarse.grid.size());
      Level level = report.level == coarsest_ ? make_level(box, lambda, bricks, field.grid, field.f, context_, norm_)
                                              : prolong_level(coarse, box, bricks, field, context_);
      level.lambda = lambda;
      solve(level, report, params_.max_iterations);
      const bool decides = last_ == 0 && report.level == start_;
      if (!decides || growth(level, nullptr, context_).count() == 0) return level;
    }
  }

  /// The level below `coarse`, on a band that grows until its interface stays inside; above the finest level it is
  /// widened once if it does not converge. The finest one of an open surface does not grow by a few bricks: films over
  /// wide gaps almost always reach some, none of them near samples, and all coarser levels would be solved again.
  Level solve_on_band(Level coarse, const SupportField& field, double allowed, LevelReport& report) {
    const LevelBox box = lattice_.box(report.level);
    if (report.level > 0) scale_flux(coarse, flux_kept(report.level), context_);
    BrickMask band = choose_band(coarse, box, field, allowed, context_);
    // Keeping a quarter of the finest level's memory for the rare band that has to grow is too much. It is freed; if
    // the band grows after all, the levels down to this one are solved once more.
    const bool finest = report.level == 0;
    constexpr size_t kept = 10;  // a tenth of the coarser level remains while it is freed
    begin(report.level, band, finest ? coarse.grid.size() / kept : coarse.grid.size());
    Level level = finest ? prolong_level(std::move(coarse), box, band, field, context_)
                         : prolong_level(coarse, box, band, field, context_);
    const BrickGrid held = finest ? std::move(coarse.grid) : coarse.grid;
    if (finest) coarse = {};
    bool tight = !finest && params_.max_iterations > patience;
    int stalls = 0;
    for (;;) {
      const int left = params_.max_iterations - report.iterations;
      solve(level, report, tight ? std::min(patience, left) : left);
      stalls += report.stop == Stop::stalled;
      if (report.band_growths == max_growths) return level;
      const BrickMask grown = growth(level, &held, context_);
      const bool widen = tight && !report.converged && report.stop != Stop::settled && report.stop != Stop::spent;
      const double few = finest && box.open ? few_bricks * static_cast<double>(band.count()) : 0;
      if (static_cast<double>(grown.count()) <= few && !widen) return level;
      if (report.iterations >= params_.max_iterations || stalls > 1) return level;
      band |= grown;
      if (widen) {
        band = widened(band, held);
        tight = false;
      }
      begin(report.level, band, held.size());
      if (coarse.grid.size() == 0)
        coarse = Descent(lattice_, support_, lambda_, params_, context_, norm_, {}).to(1).finest;
      level = prolong_level(coarse, box, band, field, context_, std::move(level));
      ++report.band_growths;
    }
  }

  void begin(int level, const BrickMask& bricks, size_t beside) const {
    if (observe_.begins) observe_.begins(level, bricks.count(), beside);
  }

  /// By the work that the level may take. The finest, those for a decision and those of closed surfaces may take all.
  int iterations_left(const Level& level, const LevelReport& report) const {
    if (!lattice_.open || !params_.settle || report.level == 0 || last_ > 0) return std::numeric_limits<int>::max();
    const double finest = static_cast<double>(support_.grid.vertices()) * usual_iterations;
    const double all = most_work(report.level) * finest / static_cast<double>(level.grid.vertices());
    return std::max(least_iterations, static_cast<int>(std::min(all, 1e9)) - report.iterations);
  }

  void solve(Level& level, LevelReport& report, int most_iterations) const {
    PrimalDualParams params = params_;
    const int may = iterations_left(level, report);
    params.max_iterations = std::min(most_iterations, may);
    const bool rough = last_ > 0 && report.level <= start_;
    report.tolerance = params.tolerance =
        rough ? params_.tolerance : tolerance_of(report.level, start_, params_.tolerance);
    params.step_balance *= balance_of(report.level, start_);
    PrimalDualRun run;
    // Reduced flux (flux_kept()) has not settled yet: of the levels on a band only the finest keeps all flux.
    run.late = report.level == 0 && start_ > 0;
    run.stalls = report.level < start_;
    run.settles = run.stalls && report.level <= 1;
    run.checked = [&](int iterations, double gap) {
      context_.progress().advance(
          1.0 - static_cast<double>(report.level) / (coarsest_ + 1),
          fmt::format("level {}, {} iterations, gap {:.1e}", report.level, report.iterations + iterations, gap));
    };
    if (observe_.evaluated && report.level <= start_)
      run.evaluated = [&](int iterations, const Energies& e) {
        observe_.evaluated(level, report.iterations + iterations, e);
      };
    const PrimalDualReport solved = solve_primal_dual(level, params, context_, run);
    report.iterations += solved.iterations;
    report.converged = solved.converged;
    report.stop = solved.stop == Stop::limit && may <= most_iterations ? Stop::spent : solved.stop;
    report.energies = solved.energies;
  }

  const Lattice& lattice_;
  const SupportField& support_;
  double lambda_;
  const PrimalDualParams& params_;
  const Context& context_;
  Norm norm_;
  PyramidObserver observe_;
  int last_ = 0;  ///< of roughly_to()
  int coarsest_ = 0;
  int start_ = 0;  ///< the coarsest level that uses all of lambda: the last one without a band
};

}  // namespace

// A level whose data is very weak sends flux through all of the interior to spread it, up to |p| = lambda; finer levels
// do not need that flux. At full size it would stay: no finer ball contains it, so those bricks would belong to every
// band, and u would fall there while waves of p, a third of a vertex per iteration, cross from side to side. Reducing
// it on each level keeps it well inside the ball, and the flux that an interface needs is restored within a few
// iterations. Where the band boundary is close to the interface p is fixed there, so less may be removed: at level 1
// half as much, at the finest level nothing.
float flux_kept(int level) { return level == 0 ? 1.0f : level == 1 ? 0.95f : 0.9f; }

PyramidSolution solve_coarse_to_fine(const Lattice& lattice, const SupportField& support, double lambda,
                                     const PrimalDualParams& params, const Context& context, Norm norm,
                                     const PyramidObserver& observe) {
  // What is observed is whole.
  const bool observed = observe.solved || observe.evaluated;
  return Descent(lattice, support, lambda, params, observed ? alone(context) : part_of(context, 0, 1), norm, observe)
      .to(0);
}

PyramidSolution solve_coarse_levels(const Lattice& lattice, const SupportField& support, const LevelData& data,
                                    double lambda, const RoughParams& params, const Context& context,
                                    const PyramidObserver& observe) {
  return Descent(lattice, support, lambda, params.solver, alone(context), params.norm, observe)
      .roughly_to(params.last, data);
}

}  // namespace soapfilm
