#include "soapfilm/refine/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/refine/choose/coarse_fit.h"
#include "soapfilm/refine/fit/prolong_distance.h"
#include "soapfilm/refine/holes/holes.h"
#include "soapfilm/refine/topology/start.h"
#include "soapfilm/refine/topology/topology.h"

namespace soapfilm {

namespace {

/// Shares of the time after which the smoothing is chosen, and holes are curved.
constexpr double until_chosen = 0.3, until_bent = 0.6;
constexpr size_t speck = 64;  // vertices: a ball of radius 2.5, as outliers that support each other make

/// The samples decide on the fit weights. `spacing`: of the fit's vertices, voxels.
FitWeights choose(const Start& start, const GridSamples& samples, const RefineSetup& params, double spacing,
                  const Context& context, FitWeightReport& search) {
  FitWeightParams given;
  if (params.smoothing) given.smoothing = *params.smoothing / (spacing * spacing);
  if (params.normals) given.normals = *params.normals / (spacing * spacing);
  return choose_fit_weights(start, samples, params.robust, given, context, search);
}

/// The level set 0 of phi0, moved.
RowArray moved_onto(const GridSamples& samples, const Start& start, const FitWeights& fit_weights,
                    const RobustParams& params, const Context& context, FitReport& report) {
  Displacement displacement(start.band, start.phi0, context);
  CellSamples cells(samples, start.band, context);
  const RobustFit fit = fit_robustly(displacement, samples, cells, {}, fit_weights, params, context);
  report.iterations = fit.iterations;
  report.down_weighted = fit.down_weighted;
  bring_all(start.band, displacement.phi());
  return std::move(displacement.phi());
}

/// Grids of every second vertex, every fourth, ..., while samples are sparse and noisy there and each grid is as good
/// as the one before. `labels`: those of the first one.
std::vector<CoarseFit> sufficient_grids(const Start& start, Labels labels, const GridSamples& samples, double density,
                                        const RefineSetup& params, const Context& context) {
  std::vector<CoarseFit> found;
  for (double spacing = 2; density < params.sparse; density *= 4, spacing *= 2) {
    // Each grid takes half of the rest of the progress bar.
    const Context half = part_of(context, 1 - 2 / spacing, 1 - 1 / spacing);
    const Start& finer = found.empty() ? start : found.back().start;
    const GridSamples& finer_samples = found.empty() ? samples : found.back().samples;
    if (!found.empty()) labels = every_second_vertex(labels, context);
    CoarseFit next{start_from(labels, params.reach, context), on_every_second_vertex(finer_samples, context), {}, {}};
    if (next.start.band.rows() == 0) break;
    next.fit_weights = choose(next.start, next.samples, params, spacing, half, next.search);
    // The full grid has no weights yet, and needs none where the coarser one is as good.
    const FitWeights of_finer = found.empty() ? on_half_the_voxel(next.fit_weights) : found.back().fit_weights;
    if (!next.fit_weights.edge_preserving ||
        !suffices(next, {finer, finer_samples, of_finer}, params.robust, silenced(context)))
      break;
    found.push_back(std::move(next));
  }
  return found;
}

/// phi by a fit on the coarsest of the grids whose result is near the surface; nothing where there is none.
std::optional<RowArray> fit_coarser(const Start& start, std::vector<CoarseFit> grids, const RefineSetup& params,
                                    const Context& context, FitReport& report) {
  constexpr double least_far = 1.5, far_of_noise = 2.5;  // coarse voxels
  for (; !grids.empty(); grids.pop_back()) {
    const CoarseFit& grid = grids.back();
    const double spacing = std::ldexp(1.0, static_cast<int>(grids.size()));
    RowArray phi = moved_onto(grid.samples, grid.start, grid.fit_weights, params.robust, context, report);
    report.fit_weights = grid.fit_weights;
    for (size_t k = grids.size(); k-- > 0;) {
      const Start& finer = k > 0 ? grids[k - 1].start : start;
      phi = prolong_distance(grids[k].start.band, phi, finer.band, finer.phi0, context);
      report.fit_weights = on_half_the_voxel(report.fit_weights);
    }
    if (!is_near(start, phi, std::max(least_far, far_of_noise * grid.fit_weights.noise) * spacing, context)) continue;
    report.search = grid.search;
    report.search.held_out_error *= spacing;
    report.spacing = spacing;
    return phi;
  }
  return std::nullopt;
}

/// Beyond an open border a brick's values go on as they are in front of it.
void continue_beyond(const LevelBox& box, Vec3i brick, float* values) {
  if (!box.open || !has_free(box, brick)) return;
  const Vec3i first = brick * brick_side;
  free_range(box, brick).for_each_fixed({}, brick_side, [&](int x, int y, int z) {
    const Vec3i from = nearest_free(box, first + Vec3i{x, y, z}) - first;
    values[brick_offset(x, y, z)] = values[brick_offset(from.x, from.y, from.z)];
  });
}

/// Of the bricks with samples in and around a hole, whose vertices are on the half-resolution grid.
bool is_mostly_among(const BrickMask& bricks, const BrickGrid& sampled, const HoleSurface& hole) {
  BrickMask around(bricks.bricks());
  for (const Vec3i v : hole)
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i at = brick_of(2 * v) + slot_offset(slot); around.contains(at)) around.set(at);
  size_t all = 0, among = 0;
  around.for_each([&](Vec3i at) {
    if (sampled.find(at) < 0) return;
    ++all;
    among += bricks.test(at);
  });
  return 2 * among > all;
}

/// The distance on the band, and only its sign beyond it; moves the start's grid.
DistanceField distance_field(Start& start, const RowArray& distance, const SignBits& signs, const Context& context) {
  Field<float> value(start.grid, pages_of(context));
  parallel_for(context, start.grid.size(), 64, [&](size_t b) {
    float* out = value.brick(b);
    for (int row = 0; row < brick_area; ++row) {
      const unsigned inside = signs.row(b, row & 7, row >> 3);
      for (int x = 0; x < brick_side; ++x)
        out[row * brick_side + x] = inside >> x & 1 ? DistanceField::far : -DistanceField::far;
    }
    const NarrowBand& band = start.band;
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r)
      for (int x = 0; x < brick_side; ++x)
        if (band.mask(r) >> x & 1)
          out[band.place(r) * brick_side + x] =
              distance.data()[static_cast<size_t>(r) * brick_side + static_cast<size_t>(x)];
    continue_beyond(start.box, start.grid.coord(b), out);
  });
  return {{std::move(start.grid), std::move(value), std::move(start.inside)}};
}

}  // namespace

void validate(const RefineSetup& params) {
  const auto require = [](const char* name, double value, double least, double most) {
    if (!(value >= least && value <= most))
      throw ParameterError(fmt::format("{} = {}, must be in [{:g}, {:g}]", name, value, least, most));
  };
  if (params.smoothing) require("smoothing", *params.smoothing, 1e-6, 1e6);
  if (params.normals) require("refine normals", *params.normals, 0, 1e6);
  require("refine reach", params.reach, 1, 3);
  require("refine sparse", params.sparse, 0, 1e3);
  require("refine rounds", params.robust.rounds, 1, 20);
  require("refine iterations", params.robust.solve.iterations, 1, 10000);
  require("refine tolerance", params.robust.solve.tolerance, 0, 1);
  require("refine least_scale", params.robust.least_scale, 1e-3, 10);
  require("refine scale_of_noise", params.robust.scale_of_noise, 1, 10);
  require("refine first_scale", params.robust.first_scale, 0, 10);
  require("refine slope", params.robust.slope, 0, 1e3);
  require("refine slope_along_directions", params.robust.slope_along_directions, 0, 1e3);
  require("refine slope_of_curvature", params.robust.slope_of_curvature, 1e-6, 1e3);
  require("rounds of refine reweighting_steps", static_cast<double>(params.robust.reweighting_steps.size()), 1, 20);
  for (const int steps : params.robust.reweighting_steps) require("refine reweighting_steps", steps, 1, 10000);
  require("refine reweighting_threshold", params.robust.reweighting_threshold, 1e-3, 1e3);
}

Refinement::Refinement(Labels labels, const GridSamples& samples, double density, const RefineSetup& params,
                       const Context& context, FitReport& report)
    : params_(params),
      context_(context),
      samples_(samples),
      density_(density),
      sparse_(density > 0 && density < params.sparse),
      report_(report) {
  validate(params);
  start_ = start_from(labels, params.reach, context, params.where);
  report.spacing = 1;
  if (params.holes == HoleFill::smooth && !sparse_) fill_holes(labels);
  signs_.emplace(signs_of(labels, start_, context));
  report.band_vertices = start_.band.count();
  if (sparse_) coarser_ = every_second_vertex(labels, context);
}

void Refinement::fill_holes(Labels& labels) {
  const HoleFinder finder(start_, samples_, context_);
  std::vector<HoleSurface> holes = finder.holes_to_curve(context_, report_.holes);
  if (params_.flat_among)
    holes.erase(std::remove_if(holes.begin(), holes.end(),
                               [&](const HoleSurface& hole) {
                                 return is_mostly_among(*params_.flat_among, samples_.bricks, hole);
                               }),
                holes.end());
  if (holes.empty()) return;
  chosen_ = choose(start_, samples_, params_, 1, part_of(context_, 0, until_chosen), report_.search);
  if (!params_.open) make_room(labels);
  const Context bending = part_of(context_, until_chosen, until_bent);
  if (curve_holes(labels, holes, finder, *chosen_, bending, report_.holes))
    start_ = start_from(labels, params_.reach, context_);
}

DistanceField Refinement::fit() {
  // The surface moves onto the samples, on a grid as fine as the samples allow.
  std::optional<RowArray> phi;
  if (sparse_)
    phi = fit_coarser(
        start_,
        sufficient_grids(start_, std::move(coarser_), samples_, density_, params_, part_of(context_, 0, until_bent)),
        params_, part_of(context_, until_bent, 1), report_);
  if (!phi) {
    if (!chosen_) chosen_ = choose(start_, samples_, params_, 1, part_of(context_, 0, until_bent), report_.search);
    report_.fit_weights = *chosen_;
    start_.band.share_out(Slabs::of(start_.band.grid(), context_));
    phi = moved_onto(samples_, start_, report_.fit_weights, params_.robust, part_of(context_, until_bent, 1), report_);
  }

  // Labels follow where the topology allows.
  const FlipCount flips = follow(*phi, start_.band, *signs_, held_distance, params_.vanish ? speck : 0);
  report_.flips = flips.wanted - flips.refused;
  report_.refused = flips.refused;
  report_.vanished = flips.vanished;
  return distance_field(start_, *phi, *signs_, context_);
}

DistanceField refine(Labels labels, const GridSamples& samples, double density, const RefineSetup& params,
                     const Context& context, FitReport& report) {
  return Refinement(std::move(labels), samples, density, params, context, report).fit();
}

}  // namespace soapfilm
