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
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/extract/leaf_surface.h"
#include "soapfilm/field/terms.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/segment.h"
#include "soapfilm/solve/closed_border.h"

namespace soapfilm {

namespace {

constexpr int least_levels = 2;  // below the coarsest one with leaves

/// A level's surface; empty where there is none.
DistanceField surface_of_level(const LevelSamples& level, int l, const LevelTask& task, const Context& context) {
  Grid grid = task.grid;
  grid.lattice = task.grid.lattice.of_level(l);
  grid.density *= face_area(l);
  const SupportField field = data_field(level.samples, grid.lattice.box(0), context);
  Segmentation found =
      segment(grid.lattice, field, level.samples, task.lambda * face_area(l), task.params, {}, context);
  Labels labels = labels_of(std::move(found.level), static_cast<float>(task.params.surface.threshold), context);
  if (grid.lattice.open) labels = closed_at_border(labels, context);
  if (labels.grid.size() == 0) return {};
  GridSamples fitted = level.samples;
  if (!level.views.empty()) fitted.direction = level.views;
  Trace quiet(context);
  drop_unsupported(labels, level.samples, grid, task.params, quiet, context);
  if (labels.grid.size() == 0) return {};
  FitReport report;
  return refine(std::move(labels), fitted, grid.density, refine_setup(grid, task.params, task.robust), context, report);
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

LevelSamples level_samples(const GridSamples& samples, const std::vector<Vec3f>& of_solve,
                           std::vector<float> spacings) {
  LevelSamples level{samples, {}, std::move(spacings)};
  if (of_solve.empty()) return level;
  level.views = std::exchange(level.samples.direction, of_solve);
  return level;
}

AdaptedSurface find_coarser_surfaces(LevelSamples samples, const LevelTask& task, const Context& context) {
  AdaptedSurface adapted;
  const Lattice& lattice = task.grid.lattice;
  adapted.regions = find_regions(samples, lattice, lattice.levels - least_levels, context);
  if (adapted.regions.coarsest() == 0) return adapted;
  adapted.levels.emplace_back();               // the finest one is there already
  std::vector<std::vector<Vec3i>> off = {{}};  // bricks that a level's surface misses
  for (int l = 1; l <= adapted.regions.coarsest(); ++l) {
    context.progress().advance((l - 1.0) / adapted.regions.coarsest(), fmt::format("level {}", l));
    samples = on_next_level(samples, lattice.box(l).bricks, context);
    DistanceField field = surface_of_level(samples, l, task, silenced(context));
    if (field.grid.size() == 0) {  // too coarse to have a surface
      adapted.regions = adapted.regions.up_to(l - 1);
      break;
    }
    off.push_back(misfits(samples, l, field, context));
    adapted.levels.push_back(std::move(field));
  }
  for (int l = adapted.regions.coarsest(); l >= 1; --l) adapted.regions.refine(l, off[static_cast<size_t>(l)]);
  return adapted;
}

Mesh triangles_of(AdaptedSurface& surface, Surface& finest, const Lattice& lattice, double lambda,
                  ReportDetails& details, const Context& context) {
  if (surface.levels.empty()) return triangles_of(finest, lattice, lambda, context);
  surface.levels.front() = std::move(std::get<DistanceField>(finest.field));
  give_back_disagreement(surface.regions, surface.levels, context);
  LeafField leaves = join_levels(surface.regions, surface.levels, lattice, context);
  std::vector<const BrickGrid*> grids;
  std::vector<const Field<float>*> distances;
  for (size_t l = 0; l < leaves.grids.size(); ++l) {
    grids.push_back(&leaves.grids[l]);
    distances.push_back(&leaves.distances[l]);
    details.leaves.push_back(leaves.grids[l].vertices());
  }
  Mesh mesh = extract_leaf_surface(
      grids, distances,
      [&](int level, Vec3i vertex) { return side_of_region(surface.regions, surface.levels, level, vertex); }, lattice,
      context);
  if (mesh.triangles.empty())
    throw EmptyResult("empty result: no level has a surface in its places; try --adapt off", lambda);
  DistanceField of_places;
  of_places.grid = std::move(leaves.grids.front());
  of_places.value = std::move(leaves.distances.front());
  finest.field = std::move(of_places);
  release(surface.levels);
  return mesh;
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

void carry_levels(const Regions& regions, const Lattice& lattice, const Context& context, Mesh& mesh) {
  const std::string name = "level";
  if (has_column(mesh.attributes, name)) return;
  std::vector<float> levels(mesh.vertices.size());
  parallel_for(context, levels.size(), size_t{1} << 14, [&](size_t v) {
    levels[v] = static_cast<float>(level_at(regions, lattice.to_lattice(mesh.vertices[v])));
  });
  mesh.attributes.push_back({name, std::move(levels), true});
}

void announce_levels(const ReportDetails& details, Trace& trace) {
  if (details.leaves.empty()) {
    trace.info("levels: the finest one everywhere, as no samples are sparse");
    return;
  }
  double all = 0;
  for (const size_t n : details.leaves) all += static_cast<double>(n);
  std::string shares;
  for (size_t l = 0; l < details.leaves.size(); ++l)
    shares += fmt::format("{}{:.0f} % of {} voxel{}", l == 0 ? "" : ", ",
                          100 * static_cast<double>(details.leaves[l]) / all, 1 << l, l == 0 ? "" : "s");
  trace.info(fmt::format("levels: {:.0f} cells around the surface, {}", all, shares));
}

}  // namespace soapfilm
