#include "soapfilm/refine/choose/fit_weights.h"

#include <algorithm>

#include "soapfilm/core/portable_math.h"
#include "soapfilm/refine/choose/held_out.h"

namespace soapfilm {

namespace {

constexpr double first_smoothing = 0.2;
constexpr double least_smoothing = 2e-4, most_smoothing = 200;
constexpr double smoothing_step = 4, normals_step = 4;
constexpr double shortest_bend = 1.4;            // standard deviations of the noise, which hides smaller detail
constexpr double indifference = 0.5;             // standard errors of the score within which the smoothest fit is taken
constexpr double least_noise_to_reweight = 0.1;  // voxels; with less, a small gamma suits edges and faces alike
constexpr double first_normals = 0.05, least_normals = 0.003, most_normals = 50;
constexpr double normals_agree_deg = 40;  // a larger median angle: viewing directions, not normals
// Directions between this and the above are viewing directions near the normals: the score rises little below the best
// weight and steeply above it, so they get less.
constexpr double normals_true_deg = 20;
constexpr double caution = 0.5;
constexpr double caution_when_reweighting =
    0.1;  // the slope term has more effect then, and pulls no normal towards them

// How much worse, in standard errors, the score may become with directions under edge-preserving reweighting: they keep
// phi from steepening along the noise of its own slopes, which held-out samples barely show. On smooth shapes they cost
// 4 to 11.
constexpr double directions_cost = 1;

/// Steps along one axis of (gamma, normals) while that lowers the score.
template <class Score>
double descend(double start, double step, double least, double most, Score&& score) {
  double best = start, lowest = score(start);
  for (const double factor : {step, 1 / step}) {
    bool moved = false;
    for (double next = best * factor; next >= least && next <= most; next *= factor) {
      const double value = score(next);
      if (!(value < lowest)) break;
      lowest = value;
      best = next;
      moved = true;
    }
    if (moved) break;
  }
  return best;
}

/// The minimum of a parabola through three scores in log(x), at most half a step away.
template <class Score>
double between_steps(double x, double step, double least, double most, Score&& score) {
  if (x / step < least || x * step > most) return x;
  const double a = score(x / step), b = score(x), c = score(x * step);
  const double bend = a - 2 * b + c;
  return bend > 0 ? x * portable_pow(step, std::clamp(0.5 * (a - c) / bend, -0.5, 0.5)) : x;
}

/// The largest x from `x` upwards whose score is at most `allowed`, by interpolation in log(x); score(x) must be.
template <class Score>
double largest_within(double x, double step, double most, double allowed, Score&& score) {
  while (x * step <= most && score(x * step) <= allowed) x *= step;
  if (x * step > most) return x;
  const double here = score(x), next = score(x * step);
  return x * portable_pow(step, (allowed - here) / (next - here));
}

}  // namespace

FitWeights choose_fit_weights(const Start& start, const GridSamples& samples, const RobustParams& robust,
                              const FitWeightParams& params, const Context& context, FitWeightReport& report) {
  HeldOut held_out(start, samples, robust, {}, context);
  FitWeights best{params.smoothing.value_or(first_smoothing), params.normals.value_or(0), 0, false};

  // A rough fit gives the noise, and thereby the smallest gamma to try.
  const double noise = held_out.outcome(best.smoothing, best.normals).noise;
  const double least = std::clamp(portable_pow(shortest_bend * noise, 4), least_smoothing, most_smoothing);
  if (!params.smoothing) best.smoothing = std::max(best.smoothing, least);
  best.edge_preserving = noise > least_noise_to_reweight;
  if (!best.edge_preserving) held_out.reset_curvature_weights();
  const auto score_of_smoothing = [&](double gamma) { return held_out.score(gamma, best.normals); };
  const auto search_smoothing = [&] {
    if (!params.smoothing)
      best.smoothing = descend(best.smoothing, smoothing_step, least, most_smoothing, score_of_smoothing);
  };
  search_smoothing();
  report.agreement_deg = held_out.outcome(best.smoothing, best.normals).agreement_deg;
  const auto directions_help = [&] {
    const HeldOut::Outcome without = held_out.outcome(best.smoothing, 0);
    const double allowed_cost = best.edge_preserving ? directions_cost * without.standard_error : 0;
    return held_out.score(best.smoothing, first_normals) < without.score + allowed_cost;
  };
  if (!params.normals && report.agreement_deg < normals_agree_deg && directions_help()) {
    best.normals = first_normals;
    for (int turn = 0; turn < 3; ++turn) {
      const FitWeights before = best;
      best.normals = descend(best.normals, normals_step, least_normals, most_normals,
                             [&](double normals) { return held_out.score(best.smoothing, normals); });
      search_smoothing();
      if (best.smoothing == before.smoothing && best.normals == before.normals) break;
    }
  }
  const HeldOut::Outcome found = held_out.outcome(best.smoothing, best.normals);
  report.held_out_error = found.score;
  best.noise = found.noise;
  if (!params.smoothing) {
    const double lowest = between_steps(best.smoothing, smoothing_step, least, most_smoothing, score_of_smoothing);
    const double allowed = found.score + indifference * found.standard_error;
    if (found.standard_error > 0)
      best.smoothing =
          std::max(lowest, largest_within(best.smoothing, smoothing_step, most_smoothing, allowed, score_of_smoothing));
  }
  if (!params.normals && report.agreement_deg > normals_true_deg)
    best.normals *= best.edge_preserving ? caution_when_reweighting : caution;
  report.samples = held_out.samples();
  report.candidates = held_out.candidates();
  return best;
}

}  // namespace soapfilm
