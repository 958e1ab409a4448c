#include "soapfilm/run/solve_jointly.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "soapfilm/adapt/cut_leaves.h"
#include "soapfilm/adapt/leaf_data.h"
#include "soapfilm/adapt/leaf_energy.h"
#include "soapfilm/adapt/leaf_labels.h"
#include "soapfilm/adapt/solve_leaves.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/method.h"
#include "soapfilm/run/joint_start.h"
#include "soapfilm/run/segment.h"

namespace soapfilm {

namespace {

/// The energies of the levels' sides, and the bound by their flux.
LeafEnergies energies_of(const SolvedLevels& solved, const std::vector<Level>& levels,
                         const std::vector<SupportField>& data, float threshold, const Context& context) {
  std::vector<Labels> sides;
  for (const Level& level : levels) sides.push_back(labels_of(level, threshold, context));
  std::vector<LeafLevel> leaves;
  for (size_t l = 0; l < levels.size(); ++l) leaves.push_back({&sides[l], &data[l], &levels[l]});
  return evaluate_leaves(solved.regions, leaves, solved.lattice.added, context);
}

/// The bricks that have leaves: those of the coarsest level in the whole box, and eight for each one with finer leaves.
uint64_t count_leaf_bricks(const SolvedLevels& solved) {
  const int coarsest = solved.regions.coarsest();
  auto bricks = static_cast<uint64_t>(bricks_with_free(solved.lattice.box(coarsest)).count());
  for (int l = 1; l <= coarsest; ++l) bricks += 7 * solved.regions.finer(l).count();
  return bricks;
}

/// One cut: the levels are freed before its graph is made, whose leaves near data are not counted yet.
bool plan_leaf_cut(const SolvedLevels& solved, const JointTask& task) {
  uint64_t levels = 0, bricks = 0;
  for (size_t l = 0; l < solved.levels.size(); ++l) {
    levels += solved.levels[l].bytes();
    if (!solved.levels[l].data) continue;
    const BrickGrid& grid = solved.levels[l].data->grid;
    for (size_t b = 0; b < grid.size(); ++b) bricks += solved.regions.has(static_cast<int>(l), grid.coord(b));
  }
  const double each =
      graph_vertices_per_brick * static_cast<double>(leaf_graph_bytes(neighbors_of_cut(task.params.method))) +
      mixed_brick_bytes;
  const auto graph = static_cast<uint64_t>(each * static_cast<double>(bricks));
  constexpr uint64_t grid_brick = 130;  // in a table of bricks
  const uint64_t beside = (leaf_brick_bytes + grid_brick) * count_leaf_bricks(solved);
  return task.memory.plan_kept(support_bytes(bricks), std::max(levels, graph + beside));
}

/// The iteration on all leaves.
bool plan_iteration(const SolvedLevels& solved, const CoarseLevels& coarse, MemoryBudget& memory) {
  uint64_t bytes = coarse.bytes();
  // One level is there twice, then with its followers and what was left out: 3 times as large, measured.
  uint64_t most = 0;
  for (const SolvedLevel& level : solved.levels) {
    bytes += level.bytes();
    most = std::max(most, level_bytes(3 * level.level.grid.size()));
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
  constexpr double least_gain = 0.95, enough = 2, left_out = 0.1;  // times the gap of the grid alone
  const Context quiet = silenced(context);
  const auto threshold = static_cast<float>(params.surface.threshold);
  JointSolution found{joint_start(solved, coarse, data, left_out * of_grid.binary.gap, quiet), {}};
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
  LeafCutSetup how{graph_cut_setup(task.params), lambda, {}};
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
  if (is_graph_cut(task.params.method) ? plan_leaf_cut(solved, task) : plan_iteration(solved, coarse, task.memory))
    return true;
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
  if (is_graph_cut(params.method))
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
