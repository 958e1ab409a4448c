#include "soapfilm/run/adapt.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

constexpr int least_levels = 2;  // above the coarsest one with leaves

/// The labels moved onto the samples of a level.
DistanceField fitted(Labels labels, const LevelSamples& level, double density, const RefineSetup& how,
                     const Context& context) {
  if (labels.grid.size() == 0) return {};
  GridSamples samples = level.samples;
  if (!level.views.empty()) samples.direction = level.views;
  FitReport report;
  return refine(std::move(labels), samples, density, how, context, report);
}

/// The surface of a level `above` the placed one; empty where there is none.
DistanceField surface_of_level(const LevelSamples& level, int above, const LevelTask& task, const Context& context) {
  Grid grid = task.grid;
  grid.lattice = task.grid.lattice.of_level(above);
  grid.density *= face_area(above);
  const SupportField field = data_field(level.samples, grid.lattice.box(0), context);
  Segmentation found =
      segment(grid.lattice, field, level.samples, task.lambda * face_area(above), task.params, {}, context);
  Labels labels = labels_of(std::move(found.level), static_cast<float>(task.params.surface.threshold), context);
  if (grid.lattice.open) labels = closed_at_border(labels, context);
  if (labels.grid.size() == 0) return {};
  Trace quiet(context);
  drop_unsupported(labels, level.samples, grid, task.params, quiet, context);
  return fitted(std::move(labels), level, grid.density, refine_setup(grid, task.params, task.robust), context);
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

AdaptedSurface find_finer_surfaces(const LevelSamples& samples, const Level& level, const LevelTask& task,
                                   const Context& context) {
  AdaptedSurface adapted;
  const int finer = task.grid.finer;
  adapted.lattice = task.grid.lattice.refined(finer);
  adapted.regions = find_regions(samples, adapted.lattice, task.grid.lattice.levels - least_levels,
                                 getenv("MOST") ? atof(getenv("MOST")) : 1.0, context);
  adapted.levels.resize(static_cast<size_t>(finer));
  adapted.in_places.resize(static_cast<size_t>(finer));
  Level solved;
  Labels coarse = labels_of(level, static_cast<float>(task.params.surface.threshold), context);
  LevelSamples coarser;
  for (int l = finer - 1; l >= 0; --l) {
    context.progress().advance(1 - (l + 1.0) / finer, fmt::format("level {}", l - finer));
    const Context quiet = silenced(context);
    const LevelBox box = adapted.lattice.box(l);
    const auto places = std::make_shared<const BrickMask>(places_of(adapted.regions, l, box.bricks));
    LevelSamples in_places = samples_in(*places, l + 1 == finer ? samples : coarser, box.bricks, quiet);
    if (in_places.samples.size() == 0) continue;
    const SupportField field = data_field(in_places.samples, box, quiet);
    LevelReport& report = adapted.reports.emplace_back();
    solved = solve_in_places(l + 1 == finer ? level : solved, box, places, field, task.params.solve, quiet, report);
    report.level = l - finer;
    Labels labels = with_surroundings(labels_of(solved, static_cast<float>(task.params.surface.threshold), quiet),
                                      coarse, quiet);
    coarse = labels;
    if (box.open) labels = closed_at_border(labels, quiet);
    RefineSetup how = refine_setup(task.grid, task.params, task.robust);
    how.holes = HoleFill::flat;
    how.where = places.get();
    adapted.levels[static_cast<size_t>(l)] = fitted(std::move(labels), in_places, 0, how, quiet);
    coarser = in_places;
    if (!in_places.views.empty()) in_places.samples.direction = std::move(in_places.views);
    adapted.in_places[static_cast<size_t>(l)] = std::move(in_places.samples);
  }
  return adapted;
}

void find_coarser_surfaces(const GridSamples& samples, const std::vector<Vec3f>& of_solve,
                           std::vector<float> spacings, const LevelTask& task, const Context& context,
                           AdaptedSurface& adapted) {
  const int placed = adapted.lattice.added;
  LevelSamples level{samples, {}, std::move(spacings)};
  if (!of_solve.empty()) level.views = std::exchange(level.samples.direction, of_solve);
  adapted.levels.emplace_back();  // the placed one is there already
  std::vector<std::vector<Vec3i>> off(adapted.levels.size());  // bricks that a level's surface misses
  for (int l = placed + 1; l <= adapted.regions.coarsest(); ++l) {
    context.progress().advance((l - placed - 1.0) / (adapted.regions.coarsest() - placed), fmt::format("level {}", l));
    level = on_next_level(level, adapted.lattice.box(l).bricks, context);
    DistanceField field = surface_of_level(level, l - placed, task, silenced(context));
    if (field.grid.size() == 0) {  // too coarse to have a surface
      adapted.regions = adapted.regions.up_to(l - 1);
      break;
    }
    off.push_back(misfits(level, l - placed, field, context));
    adapted.levels.push_back(std::move(field));
  }
  for (int l = adapted.regions.coarsest(); l > placed; --l) adapted.regions.refine(l, off[static_cast<size_t>(l)]);
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
