#include "soapfilm/run/solve_jointly.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "soapfilm/adapt/leaf_data.h"
#include "soapfilm/adapt/leaf_energy.h"
#include "soapfilm/adapt/leaf_labels.h"
#include "soapfilm/adapt/solve_leaves.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/children.h"
#include "soapfilm/pyramid/continue_levels.h"

namespace soapfilm {

namespace {

/// Where the leaves of all levels start from, found from the coarsest one down.
class JointStart {
 public:
  /// `data`: of each level's leaves. `left_out`: the gap that the places without bricks of their level may have, each
  /// level's.
  JointStart(SolvedLevels& solved, CoarseLevels& coarse, const std::vector<SupportField>& data, double left_out,
             const Context& context)
      : solved_(solved),
        coarse_(coarse),
        data_(data),
        left_out_(left_out),
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
      add_left_out(above, *places, l, band);
      band = with_followers(solved_.regions, l, std::move(band), above.grid);
      levels[static_cast<size_t>(l)] = continue_in_places(above, box, band, places, known_of(l), data(l), context_);
      release(l);
    }
    return levels;
  }

 private:
  Level& own(int level) { return solved_.levels[static_cast<size_t>(level)].level; }
  const SupportField& data(int level) const { return data_[static_cast<size_t>(level)]; }

  /// Adds the places that have only the coarser level's flux, those with the largest gaps first, until the others have
  /// little: that flux was found for the coarser level's data, which reach farther, and is not solved on here.
  void add_left_out(const Level& above, const BrickMask& places, int level, BrickMask& band) const {
    struct LeftOut {
      Vec3i brick;
      double gap;
    };
    std::vector<LeftOut> left =
        gather<LeftOut>(above.grid.size(), 16, context_, [&](size_t b, std::vector<LeftOut>& found) {
          for (int k = 0; k < 8; ++k) {
            const Vec3i child = child_of(above.grid.coord(b), k);
            if (places.contains(child) && places.test(child) && !band.test(child))
              found.push_back({child, outside_child(above, b, octant_of(k), data(level)).gap});
          }
        });
    double rest = 0;
    for (const LeftOut& one : left) rest += one.gap;
    std::stable_sort(left.begin(), left.end(), [](const LeftOut& a, const LeftOut& b) { return a.gap > b.gap; });
    for (const LeftOut& next : left) {
      if (rest <= left_out_) break;
      band.set(next.brick);
      rest -= next.gap;
    }
  }

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
  double left_out_;
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

}  // namespace

bool plan_joint_solve(const SolvedLevels& solved, const CoarseLevels& coarse, MemoryBudget& memory, Trace& trace) {
  uint64_t bytes = coarse.bytes();
  // One level is there twice, then with its followers and what was left out: 3 times as large, measured.
  uint64_t most = 0;
  for (const SolvedLevel& level : solved.levels) {
    bytes += level.bytes();
    most = std::max(most, level_bytes(3 * level.level.grid.size()));
  }
  if (memory.plan_kept(bytes, most)) return true;
  trace.warn(fmt::format("levels do not adapt: solving them jointly does not fit into {}", memory.room()));
  return false;
}

std::vector<Labels> solve_jointly(SolvedLevels& solved, CoarseLevels coarse, const GridSamples& samples,
                                  const ReconstructParams& params, Certificate& certificate, ReportDetails& details,
                                  const Context& context) {
  constexpr int least = 64, most = 384, check_every = 32;
  constexpr double least_gain = 0.95, enough = 2, left_out = 0.1;  // times the gap of the grid alone
  const Context quiet = silenced(context);
  const auto threshold = static_cast<float>(params.surface.threshold);
  const std::vector<SupportField> data = data_of_leaves(samples, solved.regions, solved.lattice, quiet);
  std::vector<Level> levels = JointStart(solved, coarse, data, left_out * certificate.binary.gap, quiet).find();
  coarse.clear();
  LeafEnergies found;
  const auto ends = [&](int iterations) {
    context.progress().advance(0.6 * iterations / most, fmt::format("{} iterations", iterations));
    if (iterations < least) return false;
    const double before = found.energies.gap;
    found = energies_of(solved, levels, data, threshold, quiet);
    const bool stalls = iterations > least && found.energies.gap > least_gain * before;
    return stalls || found.energies.relative_gap(certificate.lambda) <= enough * certificate.relative_gap_binary();
  };
  solve_leaves(solved.regions, levels, {params.solve.step_balance, most, check_every}, quiet, ends);
  details.of_grid = certificate;
  details.gap_at_borders = found.at_borders;
  certificate.relaxed = certificate.binary = found.energies;
  std::vector<Labels> sides = labels_of_leaves(solved.regions, levels, threshold, quiet);
  solved.levels.clear();
  return sides;
}

}  // namespace soapfilm
