#include "soapfilm/run/other_levels.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "soapfilm/adapt/agreement.h"
#include "soapfilm/adapt/surroundings.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/field/terms.h"
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
              AdaptedSurface& adapted)
      : samples_(samples),
        placed_(placed.level),
        task_(task),
        context_(context),
        adapted_(adapted),
        kept_(without_dropped(samples, placed, context)) {}

  void find_finer(MemoryBudget& memory, Trace& trace);
  void find_coarser(MemoryBudget& memory, Trace& trace);

 private:
  bool add_finer(LevelSamples& found, MemoryBudget& memory, Trace& trace);
  Labels labels(const Level& level) const {
    return labels_of(level, static_cast<float>(task_.params.surface.threshold), context_);
  }
  Labels closed(Labels labels) const { return labels.box.open ? closed_at_border(labels, context_) : labels; }

  const LevelSamples& samples_;
  const Level& placed_;
  const LevelTask& task_;
  const Context& context_;
  AdaptedSurface& adapted_;
  std::optional<LevelSamples> kept_;  ///< for finer levels, where not all are
};

/// The levels below the placed one, the next finer one from each level. Those without places, or without memory, are
/// not added.
void OtherLevels::find_finer(MemoryBudget& memory, Trace& trace) {
  LevelSamples found;
  const int planned = adapted_.lattice.added;
  int added = 0;
  while (added < planned && add_finer(found, memory, trace)) ++added;
  adapted_.lattice = task_.grid.lattice.refined(added);
  adapted_.regions = adapted_.regions.from(planned - added);
}

/// The next one; `found`: its samples, before those of the level above it. Returns false where there is none.
bool OtherLevels::add_finer(LevelSamples& found, MemoryBudget& memory, Trace& trace) {
  constexpr double bricks_of_data = 1.5;  // of the band over those of its data, measured: .8 to 1.9
  constexpr uint64_t refined_brick = 7000, kept_brick = 2300;  // bytes, measured
  const bool first = adapted_.levels.empty();
  const int l = adapted_.lattice.added - 1 - static_cast<int>(adapted_.levels.size());
  const LevelBox box = adapted_.lattice.box(l);
  // Its places: those that it or finer levels have, and around them a brick of the next coarser one. There its surface
  // is that of the coarser level, so its end is away from what the mesh takes of it.
  const BrickMask parents = with_neighbors(adapted_.regions.finer(l + 1));
  const auto places = std::make_shared<const BrickMask>(children_of(parents, box.bricks));
  // And a brick farther: so the data at their end is whole.
  LevelSamples samples = on_finer_level(!first  ? found
                                        : kept_ ? *kept_
                                                : samples_,
                                        with_neighbors(parents), box.bricks, context_);
  if (samples.samples.size() == 0) {
    if (task_.params.place.voxel)
      trace.info(fmt::format("no voxels of {:.4g}: samples are nowhere so near to each other",
                             adapted_.lattice.of_level(l).voxel));
    return false;
  }
  auto field = std::make_unique<SupportField>(data_field(samples.samples, box, context_));
  const auto bricks = static_cast<uint64_t>(bricks_of_data * static_cast<double>(field->grid.size()));
  uint64_t kept = level_bytes(bricks) + support_bytes(field->grid.size());  // with the finer levels that are there
  for (const DistanceField& level : adapted_.levels) kept += kept_brick * level.grid.size();
  for (const SolvedLevel& level : adapted_.solved) kept += level.bytes();
  if (!memory.plan_beside(refined_brick * bricks + kept)) {
    trace.warn(
        fmt::format("no voxels of {:.4g} where samples are dense: they do not fit into {}; a larger --voxel has "
                    "them where it can",
                    adapted_.lattice.of_level(l).voxel, memory.room()));
    return false;
  }
  LevelReport report;
  Level level = solve_in_places(first ? placed_ : adapted_.solved.front().level, box, places, *field,
                                task_.params.solve, context_, report);
  report.level = -1 - static_cast<int>(adapted_.levels.size());
  adapted_.reports.push_back(report);
  level.box.level = report.level;
  if (task_.observe.solved) task_.observe.solved(level, adapted_.lattice.of_level(l));
  Labels sides = with_surroundings(labels(level), first ? labels(placed_) : adapted_.solved.front().sides, context_);
  RefineSetup how = refine_setup(task_.grid, task_.params, task_.robust);
  how.holes = HoleFill::flat;
  how.where = places.get();
  // Their density is not known: where they have a sample in each voxel, it is enough.
  adapted_.levels.insert(adapted_.levels.begin(), fitted(closed(sides), samples, 0, how, context_));
  adapted_.solved.insert(adapted_.solved.begin(), {std::move(level), std::move(sides), std::move(field)});
  found = samples;
  if (!samples.views.empty()) samples.samples.direction = std::move(samples.views);
  adapted_.in_places.insert(adapted_.in_places.begin(), std::move(samples.samples));
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

/// The levels above the placed one, the next coarser one from each level; those that still have a surface.
void OtherLevels::find_coarser(MemoryBudget& memory, Trace& trace) {
  const int base = adapted_.lattice.added;
  adapted_.levels.emplace_back();  // the placed one comes later
  adapted_.solved.emplace_back();
  const uint64_t bricks = placed_.grid.size() / 4;
  if (adapted_.regions.coarsest() > base &&
      !memory.plan_beside(2 * level_bytes(bricks) + Refinement::bytes_of_level(bricks))) {
    trace.warn(fmt::format("no larger voxels where samples are sparse: they do not fit into {}", memory.room()));
    adapted_.regions = adapted_.regions.up_to(base);
  }
  std::vector<std::vector<Vec3i>> off(static_cast<size_t>(base) + 1);  // bricks that a level's surface misses
  LevelSamples samples;
  for (int l = base + 1; l <= adapted_.regions.coarsest(); ++l) {
    Grid grid = task_.grid;
    grid.lattice = task_.grid.lattice.of_level(l - base);
    grid.density *= face_area(l - base);
    const LevelBox box = adapted_.lattice.box(l);
    samples = on_next_level(l == base + 1 ? samples_ : samples, box.bricks, context_);
    auto field = std::make_unique<SupportField>(data_field(samples.samples, grid.lattice.box(0), context_));
    const Level& fine = l == base + 1 ? placed_ : adapted_.solved.back().level;
    const Segmentation alone =
        segment(grid.lattice, *field, samples.samples, task_.lambda * face_area(l - base), task_.params, {}, context_);
    const BrickMask places = coarser_places_of(adapted_.regions, l, fine.grid, alone.level.grid);
    LevelReport report;
    Level solved =
        solve_coarser_in_places(fine, alone.level, box, places, *field, task_.params.solve, context_, report);
    Labels sides = labels(solved), of_level = closed(sides);
    Trace quiet(context_);
    drop_unsupported(of_level, samples.samples, grid, task_.params, quiet, context_);
    RefineSetup how = refine_setup(grid, task_.params, task_.robust);
    how.flat_among = &adapted_.regions.asked(l);  // such holes are those of finer levels
    DistanceField surface = fitted(std::move(of_level), samples, grid.density, how, context_);
    if (surface.grid.size() == 0) {  // too coarse to have a surface
      adapted_.regions = adapted_.regions.up_to(l - 1);
      break;
    }
    off.push_back(misfits(samples, l - base, surface, context_));
    adapted_.levels.push_back(std::move(surface));
    adapted_.solved.push_back({std::move(solved), std::move(sides), std::move(field)});
  }
  for (int l = adapted_.regions.coarsest(); l > base; --l) adapted_.regions.refine(l, off[static_cast<size_t>(l)]);
}

}  // namespace

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

AdaptedSurface find_other_surfaces(const LevelSamples& samples, PlacedLevel placed, const LevelTask& task,
                                   MemoryBudget& memory, Trace& trace, const Context& context) {
  // Farther apart than two voxels of the coarsest of these, samples say too little about what lies between them.
  constexpr int most_coarser = 3;
  AdaptedSurface adapted;
  adapted.lattice = task.grid.lattice.refined(task.grid.finer);
  adapted.regions =
      find_regions(samples, adapted.lattice, std::min(task.grid.lattice.levels - 1, most_coarser), context);
  const Context quiet = silenced(context);
  OtherLevels levels(samples, placed, task, quiet, adapted);
  levels.find_finer(memory, trace);
  context.progress().advance(0.6, "coarser levels");
  levels.find_coarser(memory, trace);
  SolvedLevel& own = adapted.solved[static_cast<size_t>(adapted.lattice.added)];
  own.sides = labels_of(placed.level, static_cast<float>(task.params.surface.threshold), context);
  for (size_t b = 0; b < own.sides.bits.size(); ++b) own.sides.bits[b] ^= placed.dropped[b];
  own.level = std::move(placed.level);
  own.data = std::make_unique<SupportField>(std::move(placed.data));
  return adapted;
}

}  // namespace soapfilm
