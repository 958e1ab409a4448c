#include "soapfilm/refine/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/error.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/refine/topology.h"

namespace soapfilm {

namespace {

constexpr float far_distance = 3;       // voxels, of vertices beyond the band
constexpr float held_distance = 0.05f;  // voxels, of vertices whose sign must not follow

/// Quantile function of the standard normal distribution in [0.016, 0.984] (rational approximation of Acklam 2003).
float normal_quantile(float p) {
  const float q = p - 0.5f, r = q * q;
  const float num =
      ((((-39.6968303f * r + 220.946098f) * r - 275.928510f) * r + 138.357752f) * r - 30.6647981f) * r + 2.50662828f;
  const float den =
      ((((-54.4760988f * r + 161.585837f) * r - 155.698980f) * r + 66.8013119f) * r - 13.2806816f) * r + 1;
  return q * num / den;
}

/// The filter of section 4.1 has variance 2 along every direction, so that a plane's smoothed indicator is nearly the
/// normal distribution's.
float distance_of(float smoothed) { return 1.41421356f * normal_quantile(smoothed); }

NarrowBand make_band(const SurfaceField& field, const LevelBox& box, double reach, const Parallel& parallel) {
  const auto limit = static_cast<float>(0.5 * std::erfc(reach / 2));
  const float last = std::nextafter(1 - limit, 0.0f);  // below 1 - limit
  std::vector<uint8_t> vertices(field.grid.size() * brick_area);
  parallel.for_each(field.grid.size(), 64, [&](size_t b) {
    const float* v = field.value.brick(b);
    const BrickBits near = BrickBits::above(v, limit) & ~BrickBits::above(v, last);
    const FreeRange range = free_range(box, field.grid.coord(b));
    const unsigned free_x = range.lo.x < range.hi.x ? (1u << range.hi.x) - (1u << range.lo.x) : 0;
    for (int z = range.lo.z; z < range.hi.z; ++z)
      for (int y = range.lo.y; y < range.hi.y; ++y)
        vertices[b * brick_area + static_cast<size_t>(y + 8 * z)] = static_cast<uint8_t>(near.row(y, z) & free_x);
  });
  return NarrowBand(field.grid, vertices, parallel);
}

SignBits make_signs(const Level& level, float threshold, const SurfaceField& field, const Parallel& parallel) {
  SignBits signs(field.grid, field.inside);
  parallel.for_each(field.grid.size(), 64, [&](size_t b) {
    const int32_t n = level.grid.find(field.grid.coord(b));
    const float* u = n >= 0 ? level.u.brick(static_cast<size_t>(n)) : nullptr;
    const float constant = u ? 0 : level.missing_u(n, field.grid.coord(b));
    const BrickBits inside = u                      ? BrickBits::above(u, threshold)
                             : constant > threshold ? BrickBits::full()
                                                    : BrickBits();
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y) signs.row(b, y, z) = inside.row(y, z);
  });
  return signs;
}

/// About the signed distance to the surface, positive inside, on the band.
RowArray distance_on(const NarrowBand& band, const SurfaceField& field, const Parallel& parallel) {
  RowArray distance = band.make_array();
  parallel.for_each(band.grid().size(), 64, [&](size_t b) {
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r) {
      const float* smoothed = field.value.brick(b) + band.place(r) * brick_side;
      float* out = distance.data() + static_cast<size_t>(r) * brick_side;
      for (int x = 0; x < brick_side; ++x)
        if (band.mask(r) >> x & 1) out[x] = distance_of(smoothed[x]);
    }
  });
  return distance;
}

/// The level set 0 of phi0, moved by the strength that the report names.
RowArray moved_onto(const GridSamples& samples, const NarrowBand& band, const RowArray& phi0,
                    const RobustParams& params, const Parallel& parallel, RefineReport& report) {
  Displacement displacement(band, phi0, parallel);
  CellSamples cells(samples, band, parallel);
  const RobustFit fit = fit_robustly(displacement, band, samples, cells, {}, report.strength, params, parallel);
  report.iterations = fit.iterations;
  report.cells = fit.cells;
  report.down_weighted = fit.down_weighted;
  return std::move(displacement.phi());
}

/// The field becomes the distance on the band, and its sign alone beyond it.
void write_distance(const NarrowBand& band, const RowArray& distance, const SignBits& signs, SurfaceField& field,
                    const Parallel& parallel) {
  parallel.for_each(band.grid().size(), 64, [&](size_t b) {
    float* out = field.value.brick(b);
    for (int row = 0; row < brick_area; ++row) {
      const unsigned inside = signs.row(b, row & 7, row >> 3);
      for (int x = 0; x < brick_side; ++x) out[row * brick_side + x] = inside >> x & 1 ? far_distance : -far_distance;
    }
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r)
      for (int x = 0; x < brick_side; ++x)
        if (band.mask(r) >> x & 1)
          out[band.place(r) * brick_side + x] =
              distance.data()[static_cast<size_t>(r) * brick_side + static_cast<size_t>(x)];
  });
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

SurfaceField refine(Level level, float threshold, const GridSamples& samples, const RefineParams& params,
                    const Parallel& parallel, RefineReport& report) {
  validate(params);
  // The smoothed indicator tells roughly how far each vertex is from the surface.
  SurfaceField field = smoothed_indicator(level, threshold, parallel);
  const NarrowBand band = make_band(field, level.box, params.reach, parallel);
  const RowArray phi0 = distance_on(band, field, parallel);
  SignBits signs = make_signs(level, threshold, field, parallel);
  report.band_vertices = band.count();
  // Memory for the fit: what follows asks for the distance and the signs alone.
  level = {};
  field.value = {};

  // How much the samples are worth is for the samples to say.
  report.strength =
      choose_strength(band, phi0, samples, params.robust, {.smoothing = params.smoothing, .normals = params.normals},
                      parallel, report.search);

  // The surface moves onto them.
  RowArray phi = moved_onto(samples, band, phi0, params.robust, parallel, report);

  // Signs follow where the topology allows.
  const FlipCount flips = follow(phi, band, signs, held_distance);
  report.flips = flips.wanted - flips.refused;
  report.refused = flips.refused;
  field.value = Field<float>(field.grid);
  write_distance(band, phi, signs, field, parallel);
  return field;
}

}  // namespace soapfilm
