#include "soapfilm/run/other_levels.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "soapfilm/adapt/agreement.h"
#include "soapfilm/adapt/leaf_labels.h"
#include "soapfilm/adapt/surroundings.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/field/terms.h"
#include "soapfilm/pyramid/continue_levels.h"
#include "soapfilm/pyramid/solve_in_places.h"
#include "soapfilm/run/segment.h"
#include "soapfilm/run/surface.h"
#include "soapfilm/solve/closed_border.h"

namespace soapfilm {

namespace {

/// The labels moved onto the samples of a level.
DistanceField fitted(Labels labels, const LevelSamples& level, double density, const RefineSetup& how,
                     const Context& context) {
  if (labels.grid.size() == 0) return {};
  GridSamples samples = level.samples;
  if (!level.views.empty()) samples.direction = level.views;
  FitReport report;
  return refine(std::move(labels), samples, density, how, context, report);
}

Labels closed(Labels labels, const Context& context) {
  return labels.box.open ? closed_at_border(labels, context) : labels;
}

/// The samples that are not within a voxel of something dropped: finer voxels would find it again. None if nothing is.
std::optional<LevelSamples> without_dropped(const LevelSamples& samples, const PlacedLevel& placed,
                                            const Context& context) {
  if (std::all_of(placed.dropped.begin(), placed.dropped.end(), [](const BrickBits& b) { return b.count() == 0; }))
    return {};
  const auto is_dropped = [&](Vec3i vertex) {
    for (int k = 0; k < 27; ++k) {
      const Vec3i v = vertex + slot_offset(k);
      const int32_t n = placed.level.grid.find(brick_of(v));
      if (n >= 0 && placed.dropped[static_cast<size_t>(n)].test(v.x & 7, v.y & 7, v.z & 7)) return true;
    }
    return false;
  };
  const GridSamples& all = samples.samples;
  return select(
      samples,
      [&](size_t b, uint32_t s) {
        const Vec3d nearest = Vec3d(all.local[s]) + Vec3d{0.5, 0.5, 0.5};
        return !is_dropped(all.bricks.first_vertex(b) + Vec3i{static_cast<int>(nearest.x), static_cast<int>(nearest.y),
                                                              static_cast<int>(nearest.z)});
      },
      context);
}

/// What is found from level to level; `context` is silent.
class OtherLevels {
 public:
  OtherLevels(const LevelSamples& samples, const PlacedLevel& placed, const LevelTask& task, const Context& context,
              SolvedLevels& found)
      : samples_(samples), placed_(placed.level), task_(task), context_(context), found_(found) {}

  void find_finer(MemoryBudget& memory, Trace& trace);
  void find_coarser(MemoryBudget& memory, Trace& trace);

 private:
  bool add_finer(LevelSamples& found, MemoryBudget& memory, Trace& trace);

  const LevelSamples& samples_;
  const Level& placed_;
  const LevelTask& task_;
  const Context& context_;
  SolvedLevels& found_;
};

/// The places of a level below another one: bricks that it or finer levels have, and around them a brick of the next
/// coarser one. There its surface is that of the coarser level, so its end is away from what the mesh takes of it.
BrickMask parents_of_places(const Regions& regions, int level) { return with_neighbors(regions.finer(level + 1)); }

/// The samples there, and a brick farther: so the data at their end is whole. `coarser`: those of the next level.
LevelSamples samples_of_places(const LevelSamples& coarser, const Regions& regions, const Lattice& lattice, int level,
                               const Context& context) {
  return on_finer_level(coarser, with_neighbors(parents_of_places(regions, level)), lattice.box(level).bricks, context);
}

/// The levels below the placed one, the next finer one from each level. Those without places, or without memory, are
/// not added.
void OtherLevels::find_finer(MemoryBudget& memory, Trace& trace) {
  LevelSamples found;
  const int planned = found_.lattice.added;
  int added = 0;
  while (added < planned && add_finer(found, memory, trace)) ++added;
  found_.lattice = task_.grid.lattice.refined(added);
  found_.regions = found_.regions.from(planned - added);
}

/// The next one; `found`: its samples, before those of the level above it. Returns false where there is none.
bool OtherLevels::add_finer(LevelSamples& found, MemoryBudget& memory, Trace& trace) {
  constexpr double bricks_of_data = 1.5;    // of the band over those of its data, measured: .8 to 1.9
  constexpr uint64_t refined_brick = 7000;  // bytes, measured
  const bool first = found_.levels.empty();
  const int l = found_.lattice.added - 1 - static_cast<int>(found_.levels.size());
  const LevelBox box = found_.lattice.box(l);
  const auto places = std::make_shared<const BrickMask>(children_of(parents_of_places(found_.regions, l), box.bricks));
  LevelSamples samples = samples_of_places(!first        ? found
                                           : found_.kept ? *found_.kept
                                                         : samples_,
                                           found_.regions, found_.lattice, l, context_);
  if (samples.samples.size() == 0) {
    if (task_.params.place.voxel)
      trace.info(fmt::format("no voxels of {:.4g}: samples are nowhere so near to each other",
                             found_.lattice.of_level(l).voxel));
    return false;
  }
  auto field = std::make_unique<SupportField>(data_field(samples.samples, box, context_));
  const auto bricks = static_cast<uint64_t>(bricks_of_data * static_cast<double>(field->grid.size()));
  uint64_t kept = level_bytes(bricks) + support_bytes(field->grid.size());  // with the finer levels that are there
  for (const SolvedLevel& level : found_.levels) kept += level.bytes();
  if (!memory.plan_beside(refined_brick * bricks + kept)) {
    trace.warn(
        fmt::format("no voxels of {:.4g} where samples are dense: they do not fit into {}; a larger --voxel has "
                    "them where it can",
                    found_.lattice.of_level(l).voxel, memory.room()));
    return false;
  }
  LevelReport report;
  Level level = solve_in_places(first ? placed_ : found_.levels.front().level, box, places, *field, task_.params.solve,
                                context_, report);
  report.level = -1 - static_cast<int>(found_.levels.size());
  found_.reports.push_back(report);
  level.box.level = report.level;
  if (task_.observe.solved) task_.observe.solved(level, found_.lattice.of_level(l));
  found_.levels.insert(found_.levels.begin(), {std::move(level), std::move(field)});
  found = std::move(samples);
  return true;
}

/// The places of a level and of coarser ones, and a brick around them, as far as a surface may be there: around the
/// bricks of the finer level, and those of the level alone.
BrickMask coarser_places_of(const Regions& regions, int level, const BrickGrid& fine, const BrickGrid& alone) {
  BrickMask places(regions.finer(level).bricks());
  const auto add = [&](Vec3i brick) {
    if (!places.contains(brick)) return;
    bool near = false;
    for (int slot = 0; slot < 27; ++slot) near = near || !regions.is_finer(level, brick + slot_offset(slot));
    if (near) places.set(brick);
  };
  const auto add_around = [&](Vec3i brick) {
    for (int slot = 0; slot < 27; ++slot) add(brick + slot_offset(slot));
  };
  for (size_t b = 0; b < fine.size(); ++b) add_around(parent_of(fine.coord(b)));
  for (size_t b = 0; b < alone.size(); ++b) add_around(alone.coord(b));
  return places;
}

/// The grid of a coarser level than the placed one.
Grid coarser_grid(const Grid& placed, int above) {
  Grid grid = placed;
  grid.lattice = placed.lattice.of_level(above);
  grid.density *= face_area(above);
  return grid;
}

/// The levels above the placed one, the next coarser one from each level; those that still have a surface.
void OtherLevels::find_coarser(MemoryBudget& memory, Trace& trace) {
  const int base = found_.lattice.added;
  found_.levels.emplace_back();  // the placed one comes later
  const uint64_t bricks = placed_.grid.size() / 4;
  if (found_.regions.coarsest() > base && !memory.plan_beside(2 * level_bytes(bricks))) {
    trace.warn(fmt::format("no larger voxels where samples are sparse: they do not fit into {}", memory.room()));
    found_.regions = found_.regions.up_to(base);
  }
  const LevelSamples& all = found_.kept ? *found_.kept : samples_;
  const auto threshold = static_cast<float>(task_.params.surface.threshold);
  std::vector<Labels> sides = {labels_of(placed_, threshold, context_)};  // from the placed level up
  LevelSamples samples;
  for (int l = base + 1; l <= found_.regions.coarsest(); ++l) {
    const Lattice lattice = task_.grid.lattice.of_level(l - base);
    samples = on_next_level(l == base + 1 ? all : samples, found_.lattice.box(l).bricks, context_);
    auto field = std::make_unique<SupportField>(data_field(samples.samples, lattice.box(0), context_));
    const Level& fine = l == base + 1 ? placed_ : found_.levels.back().level;
    const Segmentation alone =
        segment(lattice, *field, samples.samples, task_.lambda * face_area(l - base), task_.params, {}, context_);
    const BrickMask places = coarser_places_of(found_.regions, l, fine.grid, alone.level.grid);
    LevelReport report;
    Level level = solve_coarser_in_places(fine, alone.level, found_.lattice.box(l), places, *field, task_.params.solve,
                                          context_, report);
    sides.push_back(labels_of(level, threshold, context_));
    if (count_faces(sides.back(), context_) == 0) {  // too coarse to have a surface
      found_.regions = found_.regions.up_to(l - 1);
      break;
    }
    found_.levels.push_back({std::move(level), std::move(field)});
  }
  for (int l = found_.regions.coarsest(); l > base; --l) {
    const auto n = static_cast<size_t>(l - base);
    give_back_disagreement(found_.regions, l, sides[n], sides[n - 1], context_);
  }
}

}  // namespace

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

uint64_t SolvedLevel::bytes() const {
  return level_bytes(level.grid.size()) + (data ? support_bytes(data->grid.size()) : 0);
}

PlacedLevel with_sides(Level level, SupportField data, float threshold, const Labels& labels, const Context& context) {
  PlacedLevel placed{std::move(level), std::move(data), {}};
  placed.dropped.resize(placed.level.grid.size());
  parallel_for(context, placed.dropped.size(), 64, [&](size_t b) {
    const BrickBits& side = labels.of(placed.level.grid.coord(b));
    float* u = placed.level.u.brick(b);
    placed.dropped[b] = BrickBits::above(u, threshold) ^ side;
    placed.dropped[b].for_each([&](int i) {
      const Vec3i v = vertex_in_brick(i);
      u[i] = side.test(v.x, v.y, v.z) ? 1.0f : 0.0f;
    });
  });
  placed.level.inside = GapSides(placed.level.grid, bricks_with_free(placed.level.box), [&](Vec3i brick) {
    return labels.test(nearest_free(placed.level.box, brick * brick_side));
  });
  return placed;
}

SolvedLevels solve_other_levels(const LevelSamples& samples, PlacedLevel placed, const LevelTask& task,
                                MemoryBudget& memory, Trace& trace, const Context& context) {
  // Farther apart than two voxels of the coarsest of these, samples say too little about what lies between them.
  constexpr int most_coarser = 3;
  SolvedLevels solved;
  solved.lattice = task.grid.lattice.refined(task.grid.finer);
  solved.regions = find_regions(samples, solved.lattice, std::min(task.grid.lattice.levels - 1, most_coarser), context);
  solved.kept = without_dropped(samples, placed, context);
  const Context quiet = silenced(context);
  OtherLevels levels(samples, placed, task, quiet, solved);
  levels.find_finer(memory, trace);
  context.progress().advance(0.6, "coarser levels");
  levels.find_coarser(memory, trace);
  SolvedLevel& own = solved.levels[static_cast<size_t>(solved.lattice.added)];
  own.level = std::move(placed.level);
  own.data = std::make_unique<SupportField>(std::move(placed.data));
  return solved;
}

AdaptedSurface find_other_surfaces(const LevelSamples& samples, const SolvedLevels& solved, std::vector<Labels>& sides,
                                   const LevelTask& task, const Context& context) {
  const Context quiet = silenced(context);
  const int placed = solved.lattice.added, coarsest = solved.regions.coarsest();
  AdaptedSurface adapted{solved.lattice, solved.regions, {}, {}};
  adapted.levels.resize(sides.size());
  adapted.in_places.resize(static_cast<size_t>(placed));
  const LevelSamples& all = solved.kept ? *solved.kept : samples;

  std::vector<LevelSamples> coarser;
  for (int l = placed + 1; l <= coarsest; ++l)
    coarser.push_back(on_next_level(coarser.empty() ? all : coarser.back(), solved.lattice.box(l).bricks, quiet));
  for (int l = coarsest; l >= placed; --l) {
    const auto n = static_cast<size_t>(l);
    if (l < coarsest) sides[n] = continued_beyond(sides[n], adapted.levels[n + 1], quiet);
    if (l == placed) break;
    const Grid grid = coarser_grid(task.grid, l - placed);
    const LevelSamples own = std::move(coarser.back());
    coarser.pop_back();
    Labels labels = closed(std::move(sides[n]), quiet);
    Trace silent(quiet);
    drop_unsupported(labels, own.samples, grid, task.params, silent, quiet);
    RefineSetup how = refine_setup(grid, task.params, task.robust);
    how.flat_among = &solved.regions.asked(l);  // such holes are those of finer levels
    adapted.levels[n] = fitted(std::move(labels), own, grid.density, how, quiet);
  }

  LevelSamples own;
  for (int l = placed - 1; l >= 0; --l) {
    const auto n = static_cast<size_t>(l);
    sides[n] = with_surroundings(sides[n], sides[n + 1], quiet);
    own = samples_of_places(l == placed - 1 ? all : own, solved.regions, solved.lattice, l, quiet);
    const BrickMask places = children_of(parents_of_places(solved.regions, l), solved.lattice.box(l).bricks);
    RefineSetup how = refine_setup(task.grid, task.params, task.robust);
    how.holes = HoleFill::flat;
    how.where = &places;
    // Their density is not known: where they have a sample in each voxel, it is enough.
    adapted.levels[n] = fitted(closed(sides[n], quiet), own, 0, how, quiet);
    adapted.in_places[n] = own.samples;
    if (!own.views.empty()) adapted.in_places[n].direction = own.views;
  }
  return adapted;
}

}  // namespace soapfilm
