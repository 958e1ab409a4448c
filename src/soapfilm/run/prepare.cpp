#include "soapfilm/run/prepare.h"

#include <fmt/core.h>

#include <utility>

#include "soapfilm/border/walls.h"
#include "soapfilm/components/scanners.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/field/terms.h"
#include "soapfilm/finish/attributes.h"
#include "soapfilm/fuse/range_surface.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/orient/area_weights.h"
#include "soapfilm/place/check_samples.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/run/defaults.h"

namespace soapfilm {

namespace {

constexpr size_t samples_per_task = size_t{1} << 15;

/// Weight that a sample without a surface around it may have. What a scanner under the open sky measured is there, as a
/// rule: a pole, a far wall. Among samples that were seen from above, as in the crowns of trees, it means less; and
/// elsewhere such samples are mostly outliers.
double trust_alone(const OrientReport& directions, const Scanners& scanners) {
  constexpr double measured = 16, from_above = 2;
  const size_t all = directions.from_normals + directions.from_sensor + directions.from_scan + directions.estimated;
  if (2 * directions.from_sensor > all && scanners.surroundings.under_open_sky()) return measured;
  return scanners.from_above ? from_above : 1;
}

bool counts_by_area(const ReconstructParams& params) {
  return params.method != Method::vrip && params.energy.by_area && !params.energy.lambda;
}

}  // namespace

Box3d check_cloud(const PointCloud& cloud, const ReconstructParams& params, const Context& context) {
  const Box3d box = check_samples(cloud, context);
  check_attributes(cloud, params.surface.attributes);
  if (params.method == Method::vrip)
    for (const Scan& scan : cloud.scans) require_range_scan(scan, params.orient.sensor);
  return box;
}

Orientation find_directions(const PointCloud& cloud, const Box3d& box, const ReconstructParams& params,
                            const Context& context) {
  const OrientSetup how{params.orient, params.border.outside == Border::solid};
  Orientation found = find_directions(cloud, box, how, context);
  if (!refines(params)) release(found.views);
  return found;
}

Scanners find_scanners(const PointCloud& cloud, const OrientReport& directions, const ReconstructParams& params,
                       const Context& context) {
  Scanners found;
  found.positions = scanner_positions(cloud, params.orient.sensor);
  found.from_above = !directions.assumed.empty();
  if (params.border.outside == Border::automatic && params.method == Method::tv)
    found.surroundings = measure_surroundings(cloud, params.orient.sensor, context);
  return found;
}

Placed place(const PointCloud& cloud, const Box3d& box, const Orientation& oriented, const Scanners& scanners,
             const ReconstructParams& params, MemoryBudget& memory, const Context& context) {
  Placed placed;
  placed.grid = place_grid(cloud, box, {oriented.surface, oriented.directions, scanners.from_above}, params.place,
                           counts_by_area(params), context);
  const Lattice& lattice = placed.grid.lattice;
  memory.plan_tables(cloud, box, lattice, placed.grid.area);
  placed.samples = sort_samples(cloud, oriented.directions, lattice, context);
  if (const double scale = weight_scale(cloud); scale != 1)
    placed.grid.warnings.push_back(
        fmt::format("weights: their median is {:.3g}; all are divided by it, as 1 means one sample", 1 / scale));
  if (placed.samples.size() == 0)
    throw SamplesError(fmt::format("none of the {} samples has a direction", cloud.size()));
  const bool scene = scanners.from_above || scanners.surroundings.stand_among_samples();
  memory.plan_grid(cloud,
                   {data_bricks(placed.samples, lattice.box(0), context).count(), scene ? Kind::scene : Kind::object});
  return placed;
}

Lambda choose_lambda(const PointCloud& cloud, const Orientation& oriented, const Scanners& scanners, const Grid& grid,
                     const ReconstructParams& params, GridSamples& samples, const Context& context) {
  // Around a scanner under the open sky samples become thin quickly, and whatever stands far away is thinly sampled.
  constexpr double share_under_sky = 0.5;
  EnergyParams energy = params.energy;
  if (scanners.surroundings.under_open_sky()) energy.lambda_per_density *= share_under_sky;
  Lambda lambda = choose(cloud, oriented.directions, grid.lattice, grid.density,
                         {energy, params.cross_validation, params.solve}, context);
  if (!counts_by_area(params)) return lambda;
  constexpr double most_weight = 50;
  const std::vector<float> weights =
      grid.weights.empty()
          ? weigh_by_area(oriented.surface, most_weight, trust_alone(oriented.report, scanners), context)
          : grid.weights;
  samples.weigh_directions(context, [&](size_t s) { return weights[samples.source[s]]; });
  return lambda;
}

std::vector<Vec3f> sort_views(std::span<const Vec3f> views, const GridSamples& samples, const Lattice& lattice,
                              const Context& context) {
  std::vector<Vec3f> sorted;
  if (views.empty()) return sorted;
  reserve_many(sorted, samples.size(), pages_of(context));
  sorted.resize(samples.size());
  parallel_for(context, samples.size(), samples_per_task, [&](size_t k) {
    sorted[k] = normalized(lattice.from_world_axes(views[samples.source[k]])) * norm(samples.direction[k]);
  });
  return sorted;
}

BorderReport find_border(SupportField& field, const Grid& grid, double lambda, const Scanners& scanners,
                         const ReconstructParams& params, const Context& context, Trace& trace) {
  const Border asked = params.border.outside;
  BorderReport border;
  if (asked == Border::automatic && params.method != Method::tv) return border;
  if (asked == Border::automatic && scanners.from_above) {
    border.chosen = Border::open;
    border.ends = true;
    border.reason = "as what is seen from above alone ends where it was not seen";
    return border;
  }
  trace.stage("border", [&] {
    if (asked == Border::automatic) {
      border = choose_border({grid.lattice, field, lambda, params.energy.norm, grid.density, grid.default_voxel},
                             scanners.surroundings, params.border, params.solve, context);
    } else {
      border.chosen = asked;
      border.ends = asked == Border::open;
      border.reason = "as asked for";
    }
  });
  return border;
}

void reverse_for_solid(const BorderReport& border, SupportField& field, GridSamples& samples, std::vector<Vec3f>& views,
                       const Context& context) {
  if (border.chosen != Border::solid) return;
  negate(field, context);
  for (Vec3f& direction : samples.direction) direction = -direction;
  for (Vec3f& view : views) view = -view;
}

void find_reversed_body(BorderReport& border, const OrientReport& given, const Scanners& scanners,
                        const ReconstructParams& params, const GridSamples& samples, const Context& context) {
  if (border.chosen != Border::solid) return;
  // A room seen from inside and a body whose normals are reversed are the same data. Scanners, the user or walls tell.
  if (params.border.outside != Border::automatic || !given.inward) return;
  if (!scanners.positions.empty()) return;
  if (look_along_walls(lattice_positions(samples), samples.direction, context)) {
    border.reason += "; if it is a body with reversed normals, give --directions estimate";
    return;
  }
  border.chosen = Border::air;
  border.turned = true;
  border.reason = "around a body that the normals point into, once they are turned over";
}

}  // namespace soapfilm
