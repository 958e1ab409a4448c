#include "soapfilm/refine/refine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "soapfilm/refine/topology.h"

namespace soapfilm {

namespace {

double now() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
struct Clock {
  double last = now();
  bool on = std::getenv("REFINE_TIMES") != nullptr;
  void lap(const char* name) {
    const double t = now();
    if (on) std::printf("    %-12s %.3f\n", name, t - last);
    last = t;
  }
};

/// Quantile function of the standard normal distribution in [0.03, 0.97] (rational approximation of Acklam 2003).
float normal_quantile(float p) {
  const float q = p - 0.5f, r = q * q;
  const float num = ((((-39.6968303f * r + 220.946098f) * r - 275.928510f) * r + 138.357752f) * r - 30.6647981f) * r +
                    2.50662828f;
  const float den =
      ((((-54.4760988f * r + 161.585837f) * r - 155.698980f) * r + 66.8013119f) * r - 13.2806816f) * r + 1;
  return q * num / den;
}

/// The filter of section 4.1 has variance 2 along every direction, so that a plane's smoothed indicator is nearly the
/// normal distribution's.
float distance_of(float smoothed) { return 1.41421356f * normal_quantile(smoothed); }

NarrowBand make_band(const SurfaceField& field, const LevelBox& box, double reach, const Parallel& parallel) {
  const auto limit = static_cast<float>(0.5 * std::erfc(reach / 2));
  std::vector<uint8_t> vertices(field.grid.size() * brick_area);
  parallel.for_each(field.grid.size(), 64, [&](size_t b) {
    const float* v = field.value.brick(b);
    const FreeRange range = free_range(box, field.grid.coord(b));
    for (int z = range.lo.z; z < range.hi.z; ++z)
      for (int y = range.lo.y; y < range.hi.y; ++y)
        for (int x = range.lo.x; x < range.hi.x; ++x) {
          const float value = v[brick_offset(x, y, z)];
          if (value > limit && value < 1 - limit)
            vertices[b * brick_area + static_cast<size_t>(y + 8 * z)] |= static_cast<uint8_t>(1 << x);
        }
  });
  return NarrowBand(field.grid, vertices, parallel);
}

SignBits make_signs(const Level& level, float threshold, const SurfaceField& field, const Parallel& parallel) {
  SignBits signs(field.grid, field.inside);
  parallel.for_each(field.grid.size(), 64, [&](size_t b) {
    const int32_t n = level.grid.find(field.grid.coord(b));
    const float* u = n >= 0 ? level.u.brick(static_cast<size_t>(n)) : nullptr;
    const float constant = u ? 0 : level.missing_u(n, field.grid.coord(b));
    for (int row = 0; row < brick_area; ++row)
      for (int x = 0; x < brick_side; ++x)
        if ((u ? u[row * brick_side + x] : constant) > threshold)
          signs.row(b, row & 7, row >> 3) |= static_cast<uint8_t>(1 << x);
  });
  return signs;
}

template <class Visit>
void for_each_row(const NarrowBand& band, const Parallel& parallel, Visit&& visit) {
  parallel.for_each(band.grid().size(), 64, [&](size_t b) {
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r) visit(b, r);
  });
}

}  // namespace

SurfaceField refine(const Level& level, float threshold, const GridSamples& samples, const RefineParams& params,
                    const Parallel& parallel, RefineReport& report) {
  Clock clock;
  SurfaceField field = smoothed_indicator(level, threshold, parallel);
  clock.lap("smooth");
  const NarrowBand band = make_band(field, level.box, params.reach, parallel);
  RowArray phi0 = band.make_array();
  for_each_row(band, parallel, [&](size_t b, uint32_t r) {
    const float* v = field.value.brick(b) + band.place(r) * brick_side;
    for (size_t x = 0; x < brick_side; ++x)
      if (band.mask(r) >> x & 1) phi0.data()[r * brick_side + x] = distance_of(v[x]);
  });
  const BandSamples where = locate(samples, band, parallel);
  clock.lap("band");
  report.band_vertices = band.count();
  report.band_slots = band.slots();

  const Strength strength = choose_strength(
      band, phi0, samples, params.robust, {.smoothing = params.smoothing, .normals = params.normals}, parallel,
      report.search);
  clock.lap("strength");
  Displacement displacement(band, phi0, parallel);
  clock.lap("levels");
  const std::vector<uint8_t> all(samples.size(), 1);
  const RobustFit fit =
      fit_robustly(displacement, band, samples, where, all, strength, params.robust, parallel);
  clock.lap("fit");
  report.strength = strength;
  report.iterations = fit.iterations;
  report.cells = fit.cells;
  for (size_t s = 0; s < samples.size(); ++s) report.down_weighted += fit.weight[s] < 0.25f;

  SignBits signs = make_signs(level, threshold, field, parallel);
  const FlipCount flips = follow(displacement.phi(), band, signs, 0.05f);
  report.flips = flips.wanted;
  report.refused = flips.refused;
  clock.lap("topology");

  constexpr float far = 3;
  parallel.for_each(field.grid.size(), 64, [&](size_t b) {
    float* out = field.value.brick(b);
    for (int row = 0; row < brick_area; ++row)
      for (int x = 0; x < brick_side; ++x)
        out[row * brick_side + x] = signs.row(b, row & 7, row >> 3) >> x & 1 ? far : -far;
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r)
      for (int x = 0; x < brick_side; ++x)
        if (band.mask(r) >> x & 1)
          out[band.place(r) * brick_side + x] = displacement.phi().data()[r * brick_side + static_cast<size_t>(x)];
  });
  clock.lap("write");
  return field;
}

}  // namespace soapfilm
