#include "soapfilm/run/solve_jointly.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "soapfilm/adapt/cut_leaves.h"
#include "soapfilm/adapt/leaf_data.h"
#include "soapfilm/adapt/leaf_energy.h"
#include "soapfilm/adapt/leaf_labels.h"
#include "soapfilm/adapt/solve_leaves.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/continue_levels.h"

namespace soapfilm {

namespace {

/// Where the leaves of all levels start from, found from the coarsest one down.
class JointStart {
 public:
  /// `data`: of each level's leaves.
  JointStart(SolvedLevels& solved, CoarseLevels& coarse, const std::vector<SupportField>& data, const Context& context)
      : solved_(solved),
        coarse_(coarse),
        data_(data),
        context_(context),
        placed_(solved.lattice.added),
        coarsest_(solved.regions.coarsest()) {}

  /// One for each level, the finest first.
  std::vector<Level> find() {
    const std::vector<BrickMask> wanted = wanted_bricks();
    std::vector<Level> levels(static_cast<size_t>(coarsest_) + 1);
    levels.back() = coarsest_level();
    for (int l = coarsest_ - 1; l >= 0; --l) {
      const Level& above = levels[static_cast<size_t>(l) + 1];
      const LevelBox box = solved_.lattice.box(l);
      const auto places = std::make_shared<const BrickMask>(children_of(solved_.regions.finer(l + 1), box.bricks));
      BrickMask band(box.bricks);
      wanted[static_cast<size_t>(l)].for_each([&](Vec3i b) {
        if (places->test(b) && above.grid.find(parent_of(b)) >= 0) band.set(b);
      });
      band = with_followers(solved_.regions, l, std::move(band), above.grid);
      levels[static_cast<size_t>(l)] = continue_in_places(above, box, band, places, known_of(l), data(l), context_);
      release(l);
    }
    return levels;
  }

 private:
  Level& own(int level) { return solved_.levels[static_cast<size_t>(level)].level; }
  const SupportField& data(int level) const { return data_[static_cast<size_t>(level)]; }

  /// What the level came from.
  void release(int level) {
    own(level) = {};
    if (Level* of_pyramid = level > placed_ ? coarse_.find(level - placed_) : nullptr) *of_pyramid = {};
  }

  /// Those of each level's solution and data, and the parents of what finer levels want.
  std::vector<BrickMask> wanted_bricks() {
    std::vector<BrickMask> wanted;
    for (int l = 0; l < coarsest_; ++l) {
      BrickMask& bricks = wanted.emplace_back(solved_.lattice.box(l).bricks);
      if (l > 0) wanted[static_cast<size_t>(l) - 1].for_each([&](Vec3i b) { bricks.set(parent_of(b)); });
      const auto add = [&](const BrickGrid& grid) {
        for (size_t b = 0; b < grid.size(); ++b)
          if (l <= placed_ || solved_.regions.has(l, grid.coord(b))) bricks.set(grid.coord(b));
      };
      add(own(l).grid);
      if (l > placed_) add(data(l).grid);
      if (const Level* of_pyramid = l > placed_ ? coarse_.find(l - placed_) : nullptr)
        add_bricks(of_pyramid->grid, bricks);
    }
    return wanted;
  }

  std::vector<KnownState> known_of(int level) {
    std::vector<KnownState> known;
    if (level < placed_) {  // elsewhere it was pulled to the coarser level's sides
      BrickMask near(solved_.lattice.box(level).bricks);
      add_bricks(data(level).grid, near);
      known.push_back({own(level), [near = with_neighbors(near)](Vec3i b) { return near.test(b); }});
    } else if (level == placed_) {
      known.push_back({own(level), all_});
    } else {
      known.push_back({own(level), [this, level](Vec3i b) { return solved_.regions.has(level, b); }});
      if (const Level* of_pyramid = coarse_.find(level - placed_)) known.push_back({*of_pyramid, all_});
    }
    return known;
  }

  Level coarsest_level() {
    const SupportField& support = data(coarsest_);
    SolvedLevel& last = solved_.levels.back();
    if (coarsest_ == placed_) {
      change_data(last.level, {*last.data, support});
      return std::move(last.level);
    }
    Level level;
    if (Level* of_pyramid = coarse_.find(coarsest_ - placed_)) {
      const SupportField none;
      level = std::move(*of_pyramid);
      level.box = solved_.lattice.box(coarsest_);
      change_data(level, {none, support});
    } else {                             // it was too coarse to be solved: from nothing
      constexpr double most_bricks = 8;  // for each one of data
      const LevelBox box = solved_.lattice.box(coarsest_);
      level = make_level(box, last.level.lambda, start_bricks(box, support.grid, most_bricks), support.grid, support.f,
                         context_, last.level.norm);
    }
    const KnownState known{last.level, [this](Vec3i b) { return solved_.regions.has(coarsest_, b); }};
    take_known(std::span(&known, 1), level, context_);
    last.level = {};
    return level;
  }

  SolvedLevels& solved_;
  CoarseLevels& coarse_;
  const std::vector<SupportField>& data_;
  const std::function<bool(Vec3i)> all_ = [](Vec3i) { return true; };
  const Context& context_;
  int placed_, coarsest_;
};

/// The energies of the levels' sides, and the bound by their flux.
LeafEnergies energies_of(const SolvedLevels& solved, const std::vector<Level>& levels,
                         const std::vector<SupportField>& data, float threshold, const Context& context) {
  std::vector<Labels> sides;
  for (const Level& level : levels) sides.push_back(labels_of(level, threshold, context));
  std::vector<LeafLevel> leaves;
  for (size_t l = 0; l < levels.size(); ++l) leaves.push_back({&sides[l], &data[l], &levels[l]});
  return evaluate_leaves(solved.regions, leaves, solved.lattice.added, context);
}

bool cuts(Method method) { return method == Method::graph_cut_6 || method == Method::graph_cut_26; }

GraphCutSetup cut_setup(const ReconstructParams& params) {
  return {params.method == Method::graph_cut_6 ? 6 : 26, params.graph_cut.weights, params.energy.norm};
}

/// One cut: the levels are freed before its graph is made, whose leaves near data are not counted yet.
bool plan_cut(const SolvedLevels& solved, const JointTask& task) {
  uint64_t levels = 0, bricks = 0;
  for (size_t l = 0; l < solved.levels.size(); ++l) {
    levels += solved.levels[l].bytes();
    if (!solved.levels[l].data) continue;
    const BrickGrid& grid = solved.levels[l].data->grid;
    for (size_t b = 0; b < grid.size(); ++b) bricks += solved.regions.has(static_cast<int>(l), grid.coord(b));
  }
  const double each =
      graph_vertices_per_brick * static_cast<double>(leaf_graph_bytes(cut_setup(task.params).neighbors)) +
      mixed_brick_bytes;
  const auto graph = static_cast<uint64_t>(each * static_cast<double>(bricks));
  return task.memory.plan_kept(support_bytes(bricks), std::max(levels, graph));
}

/// The iteration on all leaves.
bool plan_iteration(const SolvedLevels& solved, const CoarseLevels& coarse, MemoryBudget& memory) {
  uint64_t bytes = coarse.bytes();
  uint64_t most = 0;  // one level is there twice, once with its followers: with twice as many bricks, measured
  for (const SolvedLevel& level : solved.levels) {
    bytes += level.bytes();
    most = std::max(most, level_bytes(2 * level.level.grid.size()));
  }
  return memory.plan_kept(bytes, most);
}

void warn_too_large(const JointTask& task) {
  task.trace.warn(fmt::format("levels do not adapt: solving them jointly does not fit into {}", task.memory.room()));
}

struct JointSolution {
  std::vector<Level> levels;
  LeafEnergies energies;
};

/// The leaves as tv's iteration leaves them.
JointSolution iterated_leaves(SolvedLevels& solved, CoarseLevels& coarse, const std::vector<SupportField>& data,
                              const ReconstructParams& params, const Certificate& of_grid, const Context& context) {
  constexpr int least = 64, most = 384, check_every = 32;
  constexpr double least_gain = 0.95, enough = 2;  // times the gap of the grid alone
  const Context quiet = silenced(context);
  const auto threshold = static_cast<float>(params.surface.threshold);
  JointSolution found{JointStart(solved, coarse, data, quiet).find(), {}};
  coarse.clear();
  const auto ends = [&](int iterations) {
    context.progress().advance(0.6 * iterations / most, fmt::format("{} iterations", iterations));
    if (iterations < least) return false;
    const double before = found.energies.energies.gap;
    found.energies = energies_of(solved, found.levels, data, threshold, quiet);
    const Energies& now = found.energies.energies;
    const bool stalls = iterations > least && now.gap > least_gain * before;
    return stalls || now.relative_gap(of_grid.lambda) <= enough * of_grid.relative_gap_binary();
  };
  solve_leaves(solved.regions, found.levels, {params.solve.step_balance, most, check_every}, quiet, ends);
  return found;
}

/// The leaves on both sides of the cheapest cut, which needs nothing of the levels' own solutions: frees them.
std::optional<JointSolution> cut_all_leaves(SolvedLevels& solved, const std::vector<SupportField>& data,
                                            const JointTask& task, double lambda, const Context& context,
                                            GraphCutReport& report) {
  solved.levels.clear();
  uint64_t data_bytes = 0;
  for (const SupportField& field : data) data_bytes += support_bytes(field.grid.size());
  LeafCutSetup how{cut_setup(task.params), lambda, {}};
  how.fits = [&](size_t leaves, uint64_t beside) {
    return task.memory.plan_kept(data_bytes, leaf_graph_bytes(how.graph.neighbors) * leaves + beside);
  };
  std::optional<std::vector<Level>> levels = cut_leaves(solved.regions, solved.lattice, data, how, context, report);
  if (!levels) return {};
  const auto threshold = static_cast<float>(task.params.surface.threshold);
  const LeafEnergies energies = energies_of(solved, *levels, data, threshold, silenced(context));
  return JointSolution{std::move(*levels), energies};
}

}  // namespace

bool plan_joint_solve(const SolvedLevels& solved, const CoarseLevels& coarse, const JointTask& task) {
  if (cuts(task.params.method) ? plan_cut(solved, task) : plan_iteration(solved, coarse, task.memory)) return true;
  warn_too_large(task);
  return false;
}

std::optional<std::vector<Labels>> solve_jointly(SolvedLevels& solved, CoarseLevels coarse, const GridSamples& samples,
                                                 const JointTask& task, Certificate& certificate,
                                                 ReportDetails& details, const Context& context) {
  const ReconstructParams& params = task.params;
  const Context quiet = silenced(context);
  const auto threshold = static_cast<float>(params.surface.threshold);
  const std::vector<SupportField> data = data_of_leaves(samples, solved.regions, solved.lattice, quiet);
  std::optional<JointSolution> found;
  if (cuts(params.method))
    found = cut_all_leaves(solved, data, task, certificate.lambda, context, details.solve.leaf_cut.emplace());
  else
    found = iterated_leaves(solved, coarse, data, params, certificate, context);
  if (!found) {
    details.solve.leaf_cut.reset();
    warn_too_large(task);
    return {};
  }
  details.of_grid = certificate;
  details.gap_at_borders = found->energies.at_borders;
  certificate.relaxed = certificate.binary = found->energies.energies;
  std::vector<Labels> sides = labels_of_leaves(solved.regions, found->levels, threshold, quiet);
  solved.levels.clear();
  return sides;
}

}  // namespace soapfilm
