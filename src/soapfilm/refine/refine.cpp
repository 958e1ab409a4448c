#include "soapfilm/refine/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "soapfilm/core/error.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/refine/coarser.h"
#include "soapfilm/refine/prolong_distance.h"
#include "soapfilm/refine/start.h"
#include "soapfilm/refine/topology.h"

namespace soapfilm {

namespace {

constexpr float far_distance = 3;       // voxels, of vertices beyond the band
constexpr float held_distance = 0.05f;  // voxels, of vertices whose sign must not follow

SignBits make_signs(const Level& level, float threshold, const Start& start, const Parallel& parallel) {
  SignBits signs(start.grid, start.inside);
  parallel.for_each(start.grid.size(), 64, [&](size_t b) {
    const int32_t n = level.grid.find(start.grid.coord(b));
    const float* u = n >= 0 ? level.u.brick(static_cast<size_t>(n)) : nullptr;
    const float constant = u ? 0 : level.missing_u(n, start.grid.coord(b));
    const BrickBits inside = u                      ? BrickBits::above(u, threshold)
                             : constant > threshold ? BrickBits::full()
                                                    : BrickBits();
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y) signs.row(b, y, z) = inside.row(y, z);
  });
  return signs;
}

/// How much the samples are worth is for the samples to say. `spacing`: of the fit's vertices, voxels.
void choose(const Start& start, const GridSamples& samples, const RefineParams& params, double spacing,
            const Parallel& parallel, RefineReport& report) {
  StrengthParams given;
  if (params.smoothing) given.smoothing = *params.smoothing / (spacing * spacing);
  if (params.normals) given.normals = *params.normals / (spacing * spacing);
  report.strength = choose_strength(start, samples, params.robust, given, parallel, report.search);
}

/// The level set 0 of phi0, moved by the strength that the report names.
RowArray moved_onto(const GridSamples& samples, const Start& start, const RobustParams& params,
                    const Parallel& parallel, RefineReport& report) {
  Displacement displacement(start.band, start.phi0, parallel);
  CellSamples cells(samples, start.band, parallel);
  const RobustFit fit = fit_robustly(displacement, start.band, samples, cells, {}, report.strength, params, parallel);
  report.iterations = fit.iterations;
  report.cells = fit.cells;
  report.down_weighted = fit.down_weighted;
  return std::move(displacement.phi());
}

/// phi by a fit on the coarsest grid that serves as well as the next finer one, where there is noise to average; empty
/// where there is none.
RowArray fit_coarser(const Start& start, const GridSamples& samples, std::vector<Coarser> coarser,
                     const RefineParams& params, const Parallel& parallel, RefineReport& report) {
  constexpr double least_far = 1.5, far_of_noise = 2.5;  // coarse voxels
  const auto finer_than = [&](size_t k) -> const Start& { return k > 0 ? coarser[k - 1].start : start; };
  for (; !coarser.empty(); coarser.pop_back()) {
    const size_t last = coarser.size() - 1;
    const Coarser& problem = coarser[last];
    const double spacing = std::ldexp(1.0, static_cast<int>(coarser.size()));
    choose(problem.start, problem.samples, params, spacing, parallel, report);
    Strength& strength = report.strength;
    if (!strength.yield || !serves(problem, strength, finer_than(last), last > 0 ? coarser[last - 1].samples : samples,
                                   params.robust, parallel))
      continue;
    RowArray phi = moved_onto(problem.samples, problem.start, params.robust, parallel, report);
    const double far = std::max(least_far, far_of_noise * strength.noise) * spacing;
    for (size_t k = coarser.size(); k-- > 0;) {
      phi = prolong_distance(coarser[k].start.band, phi, finer_than(k).band, finer_than(k).phi0, parallel);
      strength = on_half_the_voxel(strength);
    }
    if (!is_near(start, phi, far, parallel)) continue;
    report.search.held_out_error *= spacing;
    report.spacing = spacing;
    return phi;
  }
  return {};
}

/// The distance on the band, and its sign alone beyond it.
SurfaceField distance_field(Start start, const RowArray& distance, const SignBits& signs, const Parallel& parallel) {
  Field<float> value(start.grid);
  parallel.for_each(start.grid.size(), 64, [&](size_t b) {
    float* out = value.brick(b);
    for (int row = 0; row < brick_area; ++row) {
      const unsigned inside = signs.row(b, row & 7, row >> 3);
      for (int x = 0; x < brick_side; ++x) out[row * brick_side + x] = inside >> x & 1 ? far_distance : -far_distance;
    }
    const NarrowBand& band = start.band;
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r)
      for (int x = 0; x < brick_side; ++x)
        if (band.mask(r) >> x & 1)
          out[band.place(r) * brick_side + x] =
              distance.data()[static_cast<size_t>(r) * brick_side + static_cast<size_t>(x)];
  });
  return {std::move(start.grid), std::move(value), std::move(start.inside)};
}

}  // namespace

void validate(const RefineParams& params) {
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
  require("refine yielding_rounds", params.robust.yielding_rounds, 0, 20);
  require("refine yielding_haste", params.robust.yielding_haste, 1, 10000);
  require("refine yielding_bend", params.robust.yielding_bend, 1e-3, 1e3);
}

SurfaceField refine(Level level, float threshold, const GridSamples& samples, double density,
                    const RefineParams& params, const Parallel& parallel, RefineReport& report) {
  validate(params);
  Start start = start_from(level, threshold, params.reach, parallel);
  SignBits signs = make_signs(level, threshold, start, parallel);
  report.band_vertices = start.band.count();
  auto coarser = coarser_problems(level, threshold, samples, density, params.sparse, params.reach, parallel);
  level = {};  // memory for the fit

  // The surface moves onto the samples, on a grid as fine as these can tell.
  RowArray phi = fit_coarser(start, samples, std::move(coarser), params, parallel, report);
  if (phi.size() == 0) {
    choose(start, samples, params, 1, parallel, report);
    phi = moved_onto(samples, start, params.robust, parallel, report);
  }

  // Signs follow where the topology allows.
  const FlipCount flips = follow(phi, start.band, signs, held_distance);
  report.flips = flips.wanted - flips.refused;
  report.refused = flips.refused;
  return distance_field(std::move(start), phi, signs, parallel);
}

}  // namespace soapfilm
