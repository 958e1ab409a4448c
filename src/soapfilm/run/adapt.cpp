#include "soapfilm/run/adapt.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <string>
#include <utility>
#include <variant>

#include "soapfilm/adapt/agreement.h"
#include "soapfilm/adapt/leaf_field.h"
#include "soapfilm/adapt/surroundings.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/extract/leaf_surface.h"
#include "soapfilm/field/terms.h"
#include "soapfilm/pyramid/solve_in_places.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/relax/relax.h"
#include "soapfilm/run/segment.h"
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

/// The places in which a level is solved: those that it or finer ones have, and around them a brick of the next
/// coarser one. There its surface is that of the coarser level, so its end is away from what the mesh takes of it.
BrickMask places_of(const Regions& regions, int level, Vec3i bricks) {
  BrickMask places(bricks);
  with_neighbors(regions.finer(level + 1)).for_each([&](Vec3i parent) {
    for (int k = 0; k < 8; ++k) places.set(child_of(parent, k));
  });
  return places;
}

/// The samples in these places, and a brick farther: so the data at their end is whole.
LevelSamples samples_in(const BrickMask& places, const LevelSamples& coarser, Vec3i bricks, const Context& context) {
  const Vec3i box{bricks.x / 2, bricks.y / 2, bricks.z / 2};
  BrickMask parents(box);
  places.for_each([&](Vec3i b) { parents.set(parent_of(b)); });
  return on_finer_level(coarser, with_neighbors(parents), bricks, context);
}

/// Of a place in the finest level, whose vertex I has those from I - 1/2 to I + 1/2.
int level_at(const Regions& regions, Vec3d place) {
  Vec3i brick;
  for (int axis = 0; axis < 3; ++axis) brick[axis] = static_cast<int>(std::floor((place[axis] + 0.5) / brick_side));
  int level = 0;
  for (; level < regions.coarsest() && !regions.has(level, brick); ++level) brick = parent_of(brick);
  return level;
}

bool has_column(const std::vector<Column>& columns, const std::string& name) {
  return std::any_of(columns.begin(), columns.end(), [&](const Column& column) { return column.name == name; });
}

}  // namespace

std::vector<float> sort_spacings(const LocalSurface& surface, const GridSamples& samples, const Grid& grid,
                                 const ReconstructParams& params, const Context& context) {
  std::vector<float> sorted;
  if (!params.place.adapt || surface.spacing.empty()) return sorted;
  sorted.resize(samples.size());
  parallel_for(context, samples.size(), size_t{1} << 15, [&](size_t k) {
    sorted[k] = static_cast<float>(static_cast<double>(surface.spacing[samples.source[k]]) / grid.lattice.voxel);
  });
  return sorted;
}

namespace {

/// The levels below the placed one, the next finer one from each level.
void find_finer(const LevelSamples& samples, const Level& placed, const LevelTask& task, const Context& context,
                AdaptedSurface& adapted) {
  const int finer = task.grid.finer;
  const auto threshold = static_cast<float>(task.params.surface.threshold);
  adapted.levels.resize(static_cast<size_t>(finer));
  adapted.in_places.resize(static_cast<size_t>(finer));
  Level solved;
  Labels coarse;
  LevelSamples coarser;
  for (int l = finer - 1; l >= 0; --l) {
    const bool first = l + 1 == finer;
    const LevelBox box = adapted.lattice.box(l);
    const auto places = std::make_shared<const BrickMask>(places_of(adapted.regions, l, box.bricks));
    LevelSamples in_places = samples_in(*places, first ? samples : coarser, box.bricks, context);
    if (in_places.samples.size() == 0) return;
    const SupportField field = data_field(in_places.samples, box, context);
    if (first) coarse = labels_of(placed, threshold, context);
    LevelReport& report = adapted.reports.emplace_back();
    solved = solve_in_places(first ? placed : solved, box, places, field, task.params.solve, context, report);
    report.level = l - finer;
    Labels labels = with_surroundings(labels_of(solved, threshold, context), coarse, context);
    coarse = labels;
    if (box.open) labels = closed_at_border(labels, context);
    RefineSetup how = refine_setup(task.grid, task.params, task.robust);
    how.holes = HoleFill::flat;
    how.where = places.get();
    adapted.levels[static_cast<size_t>(l)] = fitted(std::move(labels), in_places, 0, how, context);
    coarser = in_places;
    if (!in_places.views.empty()) in_places.samples.direction = std::move(in_places.views);
    adapted.in_places[static_cast<size_t>(l)] = std::move(in_places.samples);
  }
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
void find_coarser(LevelSamples level, const Level& placed, const LevelTask& task, const Context& context,
                  AdaptedSurface& adapted) {
  const int base = adapted.lattice.added;
  std::vector<std::vector<Vec3i>> off(static_cast<size_t>(base) + 1);  // bricks that a level's surface misses
  Level solved;
  std::list<SupportField> fields;  // the levels refer to them
  for (int l = base + 1; l <= adapted.regions.coarsest(); ++l) {
    Grid grid = task.grid;
    grid.lattice = task.grid.lattice.of_level(l - base);
    grid.density *= face_area(l - base);
    const LevelBox box = adapted.lattice.box(l);
    level = on_next_level(level, box.bricks, context);
    const SupportField& field = fields.emplace_back(data_field(level.samples, grid.lattice.box(0), context));
    const Level& fine = l == base + 1 ? placed : solved;
    const Segmentation alone =
        segment(grid.lattice, field, level.samples, task.lambda * face_area(l - base), task.params, {}, context);
    const BrickMask places = coarser_places_of(adapted.regions, l, fine.grid, alone.level.grid);
    LevelReport report;
    solved = solve_coarser_in_places(fine, alone.level, box, places, field, task.params.solve, context, report);
    Labels labels = labels_of(solved, static_cast<float>(task.params.surface.threshold), context);
    if (box.open) labels = closed_at_border(labels, context);
    Trace quiet(context);
    drop_unsupported(labels, level.samples, grid, task.params, quiet, context);
    RefineSetup how = refine_setup(grid, task.params, task.robust);
    how.flat_among = &adapted.regions.asked(l);  // such holes are those of finer levels
    DistanceField surface = fitted(std::move(labels), level, grid.density, how, context);
    if (surface.grid.size() == 0) {  // too coarse to have a surface
      adapted.regions = adapted.regions.up_to(l - 1);
      break;
    }
    off.push_back(misfits(level, l - base, surface, context));
    adapted.levels.push_back(std::move(surface));
  }
  for (int l = adapted.regions.coarsest(); l > base; --l) adapted.regions.refine(l, off[static_cast<size_t>(l)]);
}

}  // namespace

AdaptedSurface find_other_surfaces(const LevelSamples& samples, const Level& placed, const LevelTask& task,
                                   const Context& context) {
  AdaptedSurface adapted;
  adapted.lattice = task.grid.lattice.refined(task.grid.finer);
  adapted.regions = find_regions(samples, adapted.lattice, task.grid.lattice.levels - 1, 1.0, context);
  find_finer(samples, placed, task, silenced(part_of(context, 0, 0.5)), adapted);
  adapted.levels.emplace_back();  // the placed one comes later
  find_coarser(samples, placed, task, silenced(part_of(context, 0.5, 1)), adapted);
  return adapted;
}

Mesh triangles_of(AdaptedSurface& surface, Surface& placed, const Grid& grid, double lambda, ReportDetails& details,
                  const Context& context) {
  if (surface.regions.coarsest() == 0) return triangles_of(placed, grid.lattice, lambda, context);
  const auto own = static_cast<size_t>(surface.lattice.added);
  surface.levels[own] = std::move(std::get<DistanceField>(placed.field));
  give_back_disagreement(surface.regions, surface.levels, context);
  LeafField leaves = join_levels(surface.regions, surface.levels, surface.lattice, context);
  std::vector<const BrickGrid*> grids;
  std::vector<const Field<float>*> distances;
  for (size_t l = 0; l < leaves.grids.size(); ++l) {
    grids.push_back(&leaves.grids[l]);
    distances.push_back(&leaves.distances[l]);
    details.leaves.push_back(leaves.grids[l].vertices());
  }
  Mesh mesh = extract_leaf_surface(
      grids, distances,
      [&](int level, Vec3i vertex) { return side_of_region(surface.regions, surface.levels, level, vertex); },
      surface.lattice, context);
  if (mesh.triangles.empty())
    throw EmptyResult("empty result: no level has a surface in its places; try --adapt off", lambda);
  surface.levels.resize(own + 1);
  for (size_t l = 0; l <= own; ++l)
    surface.levels[l] = {{std::move(leaves.grids[l]), std::move(leaves.distances[l]), {}}};
  placed.field = std::move(surface.levels.back());
  surface.levels.pop_back();
  return mesh;
}

std::optional<RelaxReport> relax(Mesh& mesh, const Surface& surface, const GridSamples& samples,
                                 const AdaptedSurface& adapted, const Grid& grid, const ReconstructParams& params,
                                 Trace& trace, const Context& context) {
  std::optional<RelaxReport> report = relax(mesh, surface, samples, grid, params, trace, context);
  if (!report) return report;
  const Context quiet = silenced(context);
  for (size_t l = adapted.levels.size(); l-- > 0;) {
    const SurfaceField& level = adapted.levels[l];
    if (level.grid.size() == 0) continue;
    report->split_edges += relax_mesh(mesh, SmoothField(level.grid, level.value, quiet), adapted.in_places[l],
                                      surface.scale, adapted.lattice.of_level(static_cast<int>(l)),
                                      params.surface.relax, quiet)
                               .split_edges;
  }
  return report;
}

void add_spacing(SampleAttributes& attributes, const std::vector<float>& spacings, double voxel) {
  const std::string name = "spacing";
  if (has_column(attributes.columns, name)) return;
  std::vector<float> values;
  values.reserve(spacings.size());
  for (const float spacing : spacings)
    values.push_back(spacing > 0 ? static_cast<float>(static_cast<double>(spacing) * voxel)
                                 : std::numeric_limits<float>::quiet_NaN());
  attributes.columns.push_back({name, std::move(values), false});
}

void carry_levels(const AdaptedSurface& adapted, const Context& context, Mesh& mesh) {
  const std::string name = "level";
  if (has_column(mesh.attributes, name)) return;
  std::vector<float> levels(mesh.vertices.size());
  parallel_for(context, levels.size(), size_t{1} << 14, [&](size_t v) {
    levels[v] = static_cast<float>(level_at(adapted.regions, adapted.lattice.to_lattice(mesh.vertices[v])));
  });
  mesh.attributes.push_back({name, std::move(levels), true});
}

void announce_levels(const ReportDetails& details, double finest, Trace& trace) {
  if (details.leaves.empty()) {
    trace.info("levels: one everywhere, as the samples are about as dense everywhere");
    return;
  }
  double all = 0;
  for (const size_t n : details.leaves) all += static_cast<double>(n);
  std::string shares;
  for (size_t l = 0; l < details.leaves.size(); ++l)
    shares += fmt::format("{}{:.0f} % with a voxel of {:.4g}", l == 0 ? "" : ", ",
                          100 * static_cast<double>(details.leaves[l]) / all, std::ldexp(finest, static_cast<int>(l)));
  trace.info(fmt::format("levels: {:.0f} cells around the surface, {}", all, shares));
}

}  // namespace soapfilm
