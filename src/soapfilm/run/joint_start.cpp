#include "soapfilm/run/joint_start.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "soapfilm/adapt/solve_leaves.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/children.h"
#include "soapfilm/pyramid/continue_levels.h"

namespace soapfilm {

namespace {

/// Found from the coarsest level down.
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

}  // namespace

std::vector<Level> joint_start(SolvedLevels& solved, CoarseLevels& coarse, const std::vector<SupportField>& data,
                               double left_out, const Context& context) {
  return JointStart(solved, coarse, data, left_out, context).find();
}

}  // namespace soapfilm
