#include "soapfilm/run/certify_leaves.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "soapfilm/adapt/leaf_data.h"
#include "soapfilm/adapt/leaf_energy.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/flux_in_places.h"

namespace soapfilm {

PyramidObserver CoarseLevels::watch(PyramidObserver user) {
  PyramidObserver observer = user;
  observer.solved = [this, solved = std::move(user.solved)](const Level& level, const Lattice& of_level) {
    if (solved) solved(level, of_level);
    std::erase_if(levels_, [&](const Level& kept) { return kept.box.level == level.box.level; });
    if (level.box.level > 0) levels_.push_back(copy_of(level, context_));
  };
  return observer;
}

uint64_t CoarseLevels::bytes() const {
  uint64_t sum = 0;
  for (const Level& level : levels_) sum += level_bytes(level.grid.size());
  return sum;
}

Level* CoarseLevels::find(int above) {
  const auto found =
      std::find_if(levels_.begin(), levels_.end(), [&](const Level& level) { return level.box.level == above; });
  return found == levels_.end() ? nullptr : &*found;
}

namespace {

/// The flux of all levels, the coarsest first.
class FluxOfLevels {
 public:
  /// `before`: the data that each level was solved for.
  FluxOfLevels(AdaptedSurface& adapted, CoarseLevels& coarse, const std::vector<SupportField>& before,
               const PrimalDualParams& params, const Context& context)
      : adapted_(adapted),
        coarse_(coarse),
        before_(before),
        params_(params),
        context_(context),
        placed_(adapted.lattice.added),
        coarsest_(adapted.regions.coarsest()) {}

  /// One for each level, the finest first.
  std::vector<Level> find() {
    const std::vector<BrickMask> wanted = wanted_bricks();
    std::vector<Level> levels(static_cast<size_t>(coarsest_) + 1);
    levels.back() = of_coarsest();
    for (int l = coarsest_ - 1; l >= 0; --l) {
      const Level& above = levels[static_cast<size_t>(l) + 1];
      const LevelBox box = adapted_.lattice.box(l);
      const auto places = std::make_shared<const BrickMask>(children_of(adapted_.regions.finer(l + 1), box.bricks));
      BrickMask band(box.bricks);
      wanted[static_cast<size_t>(l)].for_each([&](Vec3i b) {
        if (places->test(b) && above.grid.find(parent_of(b)) >= 0) band.set(b);
      });
      levels[static_cast<size_t>(l)] =
          flux_in_places(above, box, band, places, known_of(l), *solved(l).data, params_, context_);
      solved(l).level = {};
    }
    return levels;
  }

 private:
  SolvedLevel& solved(int level) { return adapted_.solved[static_cast<size_t>(level)]; }

  /// Bricks whose data is that which the level was solved for.
  InBrick settled(int level) {
    const SupportField &before = before_[static_cast<size_t>(level)], &now = *solved(level).data;
    return [&before, &now](Vec3i brick) {
      const int32_t a = before.grid.find(brick), b = now.grid.find(brick);
      if (a < 0 || b < 0) return a < 0 && b < 0;
      const float* values = before.f.brick(static_cast<size_t>(a));
      return std::equal(values, values + brick_volume, now.f.brick(static_cast<size_t>(b)));
    };
  }

  /// Those of each level's solution and data, and the parents of what finer levels want.
  std::vector<BrickMask> wanted_bricks() {
    std::vector<BrickMask> wanted;
    for (int l = 0; l < coarsest_; ++l) {
      BrickMask& bricks = wanted.emplace_back(adapted_.lattice.box(l).bricks);
      if (l > 0) wanted[static_cast<size_t>(l) - 1].for_each([&](Vec3i b) { bricks.set(parent_of(b)); });
      const auto add = [&](const BrickGrid& grid) {
        for (size_t b = 0; b < grid.size(); ++b)
          if (l <= placed_ || adapted_.regions.has(l, grid.coord(b))) bricks.set(grid.coord(b));
      };
      add(solved(l).level.grid);
      add(solved(l).data->grid);
      if (const Level* of_pyramid = l > placed_ ? coarse_.find(l - placed_) : nullptr)
        add_bricks(of_pyramid->grid, bricks);
    }
    return wanted;
  }

  std::vector<KnownFlux> known_of(int level) {
    std::vector<KnownFlux> known;
    if (level < placed_) {  // elsewhere it was pulled to the coarser level's sides
      BrickMask data(adapted_.lattice.box(level).bricks);
      add_bricks(solved(level).data->grid, data);
      known.push_back(
          {solved(level).level, [near = with_neighbors(data)](Vec3i b) { return near.test(b); }, settled(level)});
    } else if (level == placed_) {
      known.push_back({solved(level).level, all_, settled(level)});
    } else {
      known.push_back({solved(level).level, [this, level](Vec3i b) { return adapted_.regions.has(level, b); }, none_});
      if (const Level* of_pyramid = coarse_.find(level - placed_)) known.push_back({*of_pyramid, all_, all_});
    }
    return known;
  }

  Level of_coarsest() {
    SolvedLevel& own = solved(coarsest_);
    const NewData data{before_[static_cast<size_t>(coarsest_)], *own.data};
    if (coarsest_ == placed_) {
      Level level = std::move(own.level);
      continue_flux(level, {level, none_, none_}, settled(coarsest_), data, params_, context_);
      return level;
    }
    Level level;
    if (Level* of_pyramid = coarse_.find(coarsest_ - placed_)) {
      level = std::move(*of_pyramid);
      level.box = adapted_.lattice.box(coarsest_);
    } else {                             // it was too coarse to be solved: from nothing
      constexpr double most_bricks = 8;  // for each one of data
      const LevelBox box = adapted_.lattice.box(coarsest_);
      level = make_level(box, own.level.lambda, start_bricks(box, own.data->grid, most_bricks), own.data->grid,
                         own.data->f, context_, own.level.norm);
    }
    const SupportField none;
    const KnownFlux known{own.level, [this](Vec3i b) { return adapted_.regions.has(coarsest_, b); }, none_};
    continue_flux(level, known, all_, {none, *own.data}, params_, context_);
    own.level = {};
    return level;
  }

  AdaptedSurface& adapted_;
  CoarseLevels& coarse_;
  const std::vector<SupportField>& before_;
  const InBrick all_ = [](Vec3i) { return true; }, none_ = [](Vec3i) { return false; };
  const PrimalDualParams& params_;
  const Context& context_;
  int placed_, coarsest_;
};

}  // namespace

void keep_for_certificate(AdaptedSurface& adapted, CoarseLevels& coarse, MemoryBudget& memory, Trace& trace) {
  const bool several = adapted.regions.coarsest() > 0;
  uint64_t bytes = coarse.bytes();
  uint64_t most = 0, surfaces = 0;  // one level is there twice; what refining has found stays
  for (const SolvedLevel& level : adapted.solved) {
    bytes += level.bytes();
    most = std::max(most, level_bytes(level.level.grid.size()));
    surfaces += support_bytes(level.level.grid.size());
  }
  if (several && memory.plan_kept(bytes, most + surfaces)) return;
  if (several)
    trace.warn(fmt::format("no certificate of all levels, only the grid's: it does not fit into {}", memory.room()));
  memory.plan_kept(0);
  coarse.clear();
  adapted.solved.clear();
}

Certificate certify_leaves(AdaptedSurface& adapted, CoarseLevels coarse, const GridSamples& samples,
                           const Certificate& of_grid, const PrimalDualParams& params, ReportDetails& details,
                           const Context& context) {
  if (adapted.solved.empty()) return of_grid;
  const Context quiet = silenced(context);
  std::vector<SupportField> data = data_of_leaves(samples, adapted.regions, adapted.lattice, quiet);
  for (size_t l = 0; l < data.size(); ++l) std::swap(*adapted.solved[l].data, data[l]);
  const std::vector<Level> flux = FluxOfLevels(adapted, coarse, data, params, quiet).find();
  std::vector<LeafLevel> levels;
  for (size_t l = 0; l < flux.size(); ++l)
    levels.push_back({&adapted.solved[l].sides, adapted.solved[l].data.get(), &flux[l]});
  const LeafEnergies found = evaluate_leaves(adapted.regions, levels, adapted.lattice.added, context);
  adapted.solved.clear();
  details.of_grid = of_grid;
  details.gap_at_borders = found.at_borders;
  Certificate certificate = of_grid;
  certificate.relaxed = certificate.binary = found.energies;
  return certificate;
}

}  // namespace soapfilm
