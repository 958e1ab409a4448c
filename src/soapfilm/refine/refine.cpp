#include "soapfilm/refine/refine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "soapfilm/refine/displacement.h"
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

float median_abs(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto mid = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), mid, values.end());
  return *mid;
}

/// One fit of the band to samples: robust weights, solve, and again.
struct Fit {
  const GridSamples& samples;
  const NarrowBand& band;
  const BandSamples& where;
  const RefineParams& params;
  const Parallel& parallel;
  Displacement& displacement;
  std::vector<float> weight;
  float scale = 0;
  int iterations = 0;
  size_t cells = 0;

  /// `train` leaves samples out; base weights 0 or more.
  void reweight(const std::vector<float>& base) {
    const std::vector<Jet> jets = jets_at_samples(displacement.phi(), samples, where, band, parallel);
    std::vector<float> residuals;
    for (size_t s = 0; s < jets.size(); ++s)
      if (where.cell_row[s] != 0 && base[s] > 0) residuals.push_back(std::abs(jets[s].value));
    scale = std::max(static_cast<float>(params.least_scale), 1.4826f * median_abs(residuals));
    for (size_t s = 0; s < jets.size(); ++s) {
      weight[s] = 0;
      if (where.cell_row[s] == 0) continue;
      const Vec3f n = samples.direction[s];
      if (dot(n, jets[s].gradient) > 0.3f * norm(n) * norm(jets[s].gradient)) continue;  // seen from behind
      weight[s] = base[s] * robust_weight(params.penalty, jets[s].value, scale);
    }
  }

  void run(const std::vector<float>& base, Smoothness smoothness, float normals, int rounds) {
    weight.resize(samples.size());
    for (int round = 0; round < rounds; ++round) {
      reweight(base);
      const CellSamples data = merge(samples, where, band, weight, normals, parallel);
      cells = data.cells.size();
      iterations += displacement.minimize(data, smoothness, {params.iterations, params.tolerance});
    }
  }
};

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

  const auto gamma = static_cast<float>(params.smoothing.value_or(0.003));
  const auto beta = static_cast<float>(params.slope_a * std::pow(gamma, params.slope_p));
  const auto normals = static_cast<float>(params.normals.value_or(0));

  Displacement displacement(band, phi0, parallel);
  clock.lap("levels");
  Fit fit{samples, band, where, params, parallel, displacement, {}, 0, 0, 0};
  const std::vector<float> base(samples.size(), 1.0f);
  fit.run(base, {beta, gamma}, normals, params.reweightings);
  clock.lap("fit");

  report.smoothing = gamma;
  report.slope = beta;
  report.normals = normals;
  report.noise = fit.scale;
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
