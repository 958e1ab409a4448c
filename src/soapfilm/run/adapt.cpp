#include "soapfilm/run/adapt.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "soapfilm/adapt/leaf_field.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/extract/leaf_surface.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/relax/relax.h"

namespace soapfilm {

namespace {

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

Mesh triangles_of(AdaptedSurface& surface, Surface& placed, double lambda, ReportDetails& details,
                  const Context& context) {
  const auto own = static_cast<size_t>(surface.lattice.added);
  surface.levels[own] = std::move(std::get<DistanceField>(placed.field));
  details.leaf_voxel = surface.lattice.voxel;
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
    report->split_edges +=
        relax_mesh(mesh, SmoothField(level.grid, level.value, quiet), adapted.in_places[l], surface.scale,
                   adapted.lattice.of_level(static_cast<int>(l)), params.surface.relax, quiet)
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
    levels[v] = static_cast<float>(adapted.regions.level_at(adapted.lattice.to_lattice(mesh.vertices[v])));
  });
  mesh.attributes.push_back({name, std::move(levels), true});
}

void announce_levels(const ReportDetails& details, Trace& trace) {
  if (details.leaves.empty()) {
    trace.info("levels: one everywhere, as the samples are about as dense everywhere");
    return;
  }
  double all = 0;
  for (const size_t n : details.leaves) all += static_cast<double>(n);
  std::string shares;
  for (size_t l = 0; l < details.leaves.size(); ++l)
    shares += fmt::format("{}{:.0f} % with a voxel of {:.4g}", l == 0 ? "" : ", ",
                          100 * static_cast<double>(details.leaves[l]) / all,
                          std::ldexp(details.leaf_voxel, static_cast<int>(l)));
  trace.info(fmt::format("levels: {:.0f} cells around the surface, {}", all, shares));
}

}  // namespace soapfilm
