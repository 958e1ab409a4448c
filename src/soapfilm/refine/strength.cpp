#include "soapfilm/refine/strength.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "soapfilm/core/median.h"
#include "soapfilm/core/random.h"

namespace soapfilm {

namespace {

constexpr int patch_bricks = 4;        // along each axis
constexpr double assumed_noise = 0.3;  // voxels, of the robust penalty during the search
constexpr double first_smoothing = 0.2;
constexpr double least_smoothing = 2e-4, most_smoothing = 200;
constexpr double smoothing_step = 4, normals_step = 4;
constexpr double shortest_bend = 1.4;  // standard deviations of the noise: what is smaller cannot be told from it
constexpr double indifference = 0.5;   // standard errors of the score within which the smoothest fit is taken
constexpr double least_noise_to_yield = 0.1;  // voxels; with less, a small gamma serves bends and faces alike
constexpr double first_normals = 0.05, least_normals = 0.003, most_normals = 50;
constexpr double normals_agree_deg = 40;  // a larger median angle: viewing directions, not normals
// Directions between this and that are viewing directions that lie near the normals: the score hardly rises below the
// best weight and steeply above it, so they get less.
constexpr double normals_true_deg = 20;
constexpr double caution = 0.5;
constexpr double caution_when_yielding = 0.1;  // the slopes along them say more then, and pull nothing towards them

// Standard errors that directions may cost where curvature yields: they keep phi from steepening along the noise of its
// own slopes, which held-out samples hardly show. Smooth shapes pay 4 to 11 for them.
constexpr double directions_cost = 1;

/// The bricks that samples lie in, whole patches in a random order, until there are enough samples.
BrickMask choose_patches(const GridSamples& samples, size_t wanted, uint64_t seed) {
  const BrickGrid& bricks = samples.bricks;
  std::map<std::pair<uint64_t, uint64_t>, std::vector<size_t>> patches;  // by random key, then by place
  for (size_t b = 0; b < bricks.size(); ++b) {
    const Vec3i c = bricks.coord(b);
    const uint64_t place = (static_cast<uint64_t>(c.z / patch_bricks) << 42) +
                           (static_cast<uint64_t>(c.y / patch_bricks) << 21) +
                           static_cast<uint64_t>(c.x / patch_bricks);
    patches[{Random(seed ^ place * 0x9E3779B97F4A7C15ull).next(), place}].push_back(b);
  }
  BrickMask mask(bricks.bricks());
  size_t count = 0;
  for (const auto& [key, members] : patches) {
    if (count >= wanted) break;
    for (const size_t b : members) {
      mask.set(bricks.coord(b));
      count += samples.begin[b + 1] - samples.begin[b];
    }
  }
  return mask;
}

GridSamples part_of(const GridSamples& samples, const BrickMask& bricks, const Parallel& parallel) {
  GridSamples part;
  part.bricks = BrickGrid(bricks, parallel);
  part.begin.push_back(0);
  for (size_t b = 0; b < part.bricks.size(); ++b) {
    const auto from = static_cast<size_t>(samples.bricks.find(part.bricks.coord(b)));
    for (uint32_t s = samples.begin[from]; s < samples.begin[from + 1]; ++s) {
      part.local.push_back(samples.local[s]);
      part.direction.push_back(samples.direction[s]);
      part.lot.push_back(samples.lot[s]);
    }
    part.begin.push_back(static_cast<uint32_t>(part.local.size()));
  }
  return part;
}

/// The part of a band in some bricks, renumbered, and an array on it.
std::pair<NarrowBand, RowArray> part_of(const NarrowBand& band, const RowArray& values, const BrickMask& bricks,
                                        const Parallel& parallel) {
  BrickMask mask(band.grid().bricks());
  for (size_t b = 0; b < band.grid().size(); ++b)
    if (const Vec3i c = band.grid().coord(b); bricks.contains(c) && bricks.test(c)) mask.set(c);
  BrickGrid grid(mask, parallel);
  std::vector<uint8_t> vertices(grid.size() * brick_area);
  std::vector<uint32_t> rows{0};
  for (size_t b = 0; b < grid.size(); ++b) {
    const auto from = static_cast<size_t>(band.grid().find(grid.coord(b)));
    for (uint32_t r = band.first_row(from); r < band.first_row(from + 1); ++r) {
      vertices[b * brick_area + static_cast<size_t>(band.place(r))] = band.mask(r);
      rows.push_back(r);
    }
  }
  NarrowBand part(std::move(grid), vertices, parallel);
  RowArray array = part.make_array();
  for (size_t r = 1; r < rows.size(); ++r)
    std::copy_n(values.data() + static_cast<size_t>(rows[r]) * brick_side, brick_side, array.data() + r * brick_side);
  return {std::move(part), std::move(array)};
}

class HeldOut {
  static constexpr double deviation_of_absolute = 0.6028;  // of |x|, x normal with deviation 1: sqrt(1 - 2 / pi)

 public:
  HeldOut(const NarrowBand& band, const RowArray& phi0, const GridSamples& samples, const RobustParams& robust,
          const StrengthParams& params, const Parallel& parallel)
      : robust_(robust),
        parallel_(parallel),
        patches_(choose_patches(samples, params.samples, params.seed)),
        samples_(part_of(samples, patches_, parallel)),
        part_(part_of(band, phi0, patches_, parallel)),
        cells_(samples_, part_.first, parallel),
        displacement_(part_.first, part_.second, parallel),
        train_(samples_.size()),
        first_(jets_at_samples(part_.second, samples_, cells_, part_.first, parallel)) {
    for (size_t s = 0; s < samples_.size(); ++s) train_[s] = (samples_.lot[s] & 3) != 0;  // three quarters
    robust_.rounds = 2;
    robust_.yielding_rounds = 1;
    robust_.yielding_haste = 1;
    robust_.slope_along_directions = robust_.slope;  // a steeper phi looks farther from the samples than it is
    robust_.solve.tolerance *= 0.5;                  // scores that are compared differ by little
  }

  struct Outcome {
    double score = 0;           ///< mean |phi| of the held-out samples
    double noise = 0;           ///< standard deviation of the samples from the surface, voxels, by their median
    double standard_error = 0;  ///< of the score, were the noise normal: outliers do not enter
    double agreement_deg = 0;   ///< median angle between the directions and the surface's normals
  };

  /// Of a fit to the others. Remembered, so that searches may ask twice.
  const Outcome& outcome(double smoothing, double normals) {
    const auto [it, fresh] = outcomes_.try_emplace({smoothing, normals});
    return fresh ? it->second = fit(smoothing, normals) : it->second;
  }
  double score(double smoothing, double normals) { return outcome(smoothing, normals).score; }

  /// Each fit starts with the bends that the last one yielded to: rounds saved.
  Outcome fit(double smoothing, double normals) {
    std::copy_n(part_.second.data(), part_.second.size(), displacement_.phi().data());
    fit_robustly(displacement_, part_.first, samples_, cells_, train_, {smoothing, normals, assumed_noise, yield_},
                 robust_, parallel_);
    const auto residuals = held_out_residuals();
    if (residuals.empty()) return {};
    double sum = 0;
    for (const float r : residuals) sum += r;
    const auto count = static_cast<double>(residuals.size());
    const double noise = 1.4826 * static_cast<double>(median(residuals));
    return {sum / count, noise, deviation_of_absolute * noise / std::sqrt(count), agreement()};
  }

  /// Curvature does not yield from now on.
  void stiffen() {
    yield_ = false;
    displacement_.stiffen();
    outcomes_.clear();
  }

  size_t samples() const { return samples_.size(); }
  int candidates() const { return static_cast<int>(outcomes_.size()); }

  /// Median angle between directions and the present surface's normals, degrees.
  double agreement() const {
    const auto jets = jets_at_samples(displacement_.phi(), samples_, cells_, part_.first, parallel_);
    std::vector<float> angles;
    for (size_t s = 0; s < jets.size(); ++s)
      if (jets[s])
        angles.push_back(
            std::acos(std::clamp(-dot(normalized(samples_.direction[s]), normalized(jets[s]->gradient)), -1.0f, 1.0f)));
    return 57.29578 * static_cast<double>(median(std::move(angles)));
  }

 private:
  /// Distance of the held-out samples from the surface, along the normals that it had at first: a surface that folds to
  /// be near every sample is not near them in that direction.
  std::vector<float> held_out_residuals() const {
    constexpr float least_slope = 0.02f, most_distance = 3;
    const auto jets = jets_at_samples(displacement_.phi(), samples_, cells_, part_.first, parallel_);
    std::vector<float> residuals;
    for (size_t s = 0; s < jets.size(); ++s) {
      if (!jets[s] || train_[s] || !seen_from_outside(samples_.direction[s], first_[s]->gradient)) continue;
      const float slope = dot(jets[s]->gradient, normalized(first_[s]->gradient));
      residuals.push_back(std::min(std::abs(jets[s]->value) / std::clamp(slope, least_slope, 1.0f), most_distance));
    }
    return residuals;
  }

  RobustParams robust_;
  const Parallel& parallel_;
  BrickMask patches_;
  GridSamples samples_;
  std::pair<NarrowBand, RowArray> part_;
  CellSamples cells_;
  Displacement displacement_;
  std::vector<uint8_t> train_;
  bool yield_ = true;
  std::vector<std::optional<Jet>> first_;  // of phi0
  std::map<std::pair<double, double>, Outcome> outcomes_;
};

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

/// The lowest point of a parabola through three scores in log(x), at most half a step away.
template <class Score>
double between_steps(double x, double step, double least, double most, Score&& score) {
  if (x / step < least || x * step > most) return x;
  const double a = score(x / step), b = score(x), c = score(x * step);
  const double bend = a - 2 * b + c;
  return bend > 0 ? x * std::pow(step, std::clamp(0.5 * (a - c) / bend, -0.5, 0.5)) : x;
}

/// The largest x upwards whose score is at most `allowed`, by interpolation in log(x); that of `x` is.
template <class Score>
double largest_within(double x, double step, double most, double allowed, Score&& score) {
  while (x * step <= most && score(x * step) <= allowed) x *= step;
  if (x * step > most) return x;
  const double here = score(x), next = score(x * step);
  return x * std::pow(step, (allowed - here) / (next - here));
}

}  // namespace

Strength choose_strength(const NarrowBand& band, const RowArray& phi0, const GridSamples& samples,
                         const RobustParams& robust, const StrengthParams& params, const Parallel& parallel,
                         StrengthReport& report) {
  HeldOut held_out(band, phi0, samples, robust, params, parallel);
  Strength best{params.smoothing.value_or(first_smoothing), params.normals.value_or(0), 0, false};

  // A rough fit tells the noise, and that what one must not ask for.
  const double noise = held_out.outcome(best.smoothing, best.normals).noise;
  const double least = std::clamp(std::pow(shortest_bend * noise, 4), least_smoothing, most_smoothing);
  if (!params.smoothing) best.smoothing = std::max(best.smoothing, least);
  best.yield = noise > least_noise_to_yield;
  if (!best.yield) held_out.stiffen();
  const auto score_of_smoothing = [&](double gamma) { return held_out.score(gamma, best.normals); };
  const auto search_smoothing = [&] {
    if (!params.smoothing)
      best.smoothing = descend(best.smoothing, smoothing_step, least, most_smoothing, score_of_smoothing);
  };
  search_smoothing();
  report.agreement_deg = held_out.outcome(best.smoothing, best.normals).agreement_deg;
  const auto directions_help = [&] {
    const HeldOut::Outcome without = held_out.outcome(best.smoothing, 0);
    const double allowed_cost = best.yield ? directions_cost * without.standard_error : 0;
    return held_out.score(best.smoothing, first_normals) < without.score + allowed_cost;
  };
  if (!params.normals && report.agreement_deg < normals_agree_deg && directions_help()) {
    best.normals = first_normals;
    for (int turn = 0; turn < 3; ++turn) {
      const Strength before = best;
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
    best.normals *= best.yield ? caution_when_yielding : caution;
  report.samples = held_out.samples();
  report.candidates = held_out.candidates();
  return best;
}

}  // namespace soapfilm
