#include "soapfilm/refine/choose/fit_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "refine/band_support.h"
#include "soapfilm/refine/choose/held_out.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

struct Search {
  Start start;
  GridSamples samples;
  FitWeightReport report{};

  explicit Search(const Solved& solved)
      : start(start_from(labels_of(solved.solution.finest, 0.5f, one_thread), 3, one_thread)),
        samples(solved.problem.samples) {}
  FitWeights choose(const FitWeightParams& params) {
    report = {};
    return choose_fit_weights(start, samples, {}, params, one_thread, report);
  }
};

/// What the header describes, for a given weight of normals and without edge-preserving reweighting: the lowest score
/// of all gammas in factors of 4, then as far up as half a standard error allows, or to the parabola's minimum.
double smoothing_by_scan(HeldOut& held_out, double normals) {
  const double noise = held_out.outcome(0.2, normals).noise;
  EXPECT_LE(noise, 0.1);
  held_out.reset_curvature_weights();
  const double least = std::clamp(std::pow(1.4 * noise, 4), 2e-4, 200.0);
  std::vector<double> gammas{std::max(0.2, least)};
  while (gammas.front() / 4 >= least) gammas.insert(gammas.begin(), gammas.front() / 4);
  while (gammas.back() * 4 <= 200) gammas.push_back(gammas.back() * 4);
  std::vector<double> scores;
  for (const double gamma : gammas) scores.push_back(held_out.score(gamma, normals));
  const auto best = static_cast<size_t>(std::min_element(scores.begin(), scores.end()) - scores.begin());
  double lowest = gammas[best];
  if (best > 0 && best + 1 < gammas.size()) {
    const double a = scores[best - 1], b = scores[best], c = scores[best + 1];
    lowest *= std::pow(4, 0.5 * (a - c) / (a - 2 * b + c));
  }
  const double allowed = scores[best] + 0.5 * held_out.outcome(gammas[best], normals).standard_error;
  size_t last = best;
  while (last + 1 < gammas.size() && scores[last + 1] <= allowed) ++last;
  if (last + 1 == gammas.size()) return std::max(lowest, gammas[last]);
  const double part = (allowed - scores[last]) / (scores[last + 1] - scores[last]);
  return std::max(lowest, gammas[last] * std::pow(4, part));
}

class WithoutNoise : public testing::TestWithParam<std::string> {};

TEST_P(WithoutNoise, SmoothingIsThatOfAScan) {
  for (const double noise : {0.0, 0.06}) {
    Search search(Solved(GetParam(), 40, 1, {.noise_vox = noise}));
    for (const double normals : {0.0, 0.2}) {
      const FitWeights found = search.choose({.normals = normals});
      HeldOut held_out(search.start, search.samples, {}, {}, one_thread);
      const double expected = smoothing_by_scan(held_out, normals);
      EXPECT_NEAR(found.smoothing, expected, 1e-5 * expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WithoutNoise, testing::Values("sphere", "torus"));

/// Directions that lie so many degrees off the normals, on any side.
GridSamples tilted(GridSamples samples, double degrees) {
  Random random(3);
  for (Vec3f& direction : samples.direction) {
    const Vec3d n(direction), any{random.normal(), random.normal(), random.normal()};
    const double angle = degrees * std::numbers::pi / 180;
    direction = Vec3f(n * std::cos(angle) + normalized(cross(n, any)) * (norm(n) * std::sin(angle)));
  }
  return samples;
}

/// The gamma in factors of 4 at which that score was found.
double smoothing_of(HeldOut& held_out, double normals, double score) {
  for (double gamma = 0.2 / 1024; gamma < 200; gamma *= 4)
    if (held_out.score(gamma, normals) == score) return gamma;
  ADD_FAILURE() << "no gamma gives " << score;
  return 0.2;
}

TEST(FitWeightSearch, NormalsGetTheWeightOfTheLowestScore) {
  constexpr double least_gain = 1.01;  // less does not say which weight is better
  for (const double noise : {0.05, 0.09}) {
    Search search(Solved("sphere", 40, 1, {.noise_vox = noise, .viewing = false}));
    const FitWeights found = search.choose({});
    ASSERT_GT(found.normals, 0);
    EXPECT_LT(search.report.agreement_deg, 2);
    HeldOut held_out(search.start, search.samples, {}, {}, one_thread);
    EXPECT_NEAR(found.smoothing, smoothing_by_scan(held_out, found.normals), 1e-5 * found.smoothing);
    const double error = search.report.held_out_error, gamma = smoothing_of(held_out, found.normals, error);
    EXPECT_LE(error, least_gain * held_out.score(gamma, found.normals * 4));
    EXPECT_LE(error, least_gain * held_out.score(gamma, found.normals / 4));
    EXPECT_EQ(found.noise, held_out.outcome(gamma, found.normals).noise);
    EXPECT_EQ(search.report.samples, held_out.samples());
  }
}

TEST(FitWeightSearch, NormalsThatDoNotLowerTheScoreAreNotUsed) {
  Search search(Solved("sphere", 40, 1, {.noise_vox = 0.05, .viewing = false}));
  search.samples = tilted(search.samples, 10);
  EXPECT_EQ(search.choose({}).normals, 0);
  EXPECT_NEAR(search.report.agreement_deg, 10, 0.5);
  HeldOut held_out(search.start, search.samples, {}, {}, one_thread);
  smoothing_by_scan(held_out, 0);
  const double error = search.report.held_out_error, gamma = smoothing_of(held_out, 0, error);
  EXPECT_GE(held_out.score(gamma, 0.05), error);
}

TEST(FitWeightSearch, DirectionsMoreThan40DegreesOffAreNotTried) {
  Search search(Solved("sphere", 40, 1, {.noise_vox = 0.05, .viewing = false}));
  const GridSamples exact = search.samples;
  const auto candidates_at = [&](double degrees) {
    search.samples = tilted(exact, degrees);
    EXPECT_EQ(search.choose({}).normals, 0);
    return search.report.candidates;
  };
  EXPECT_EQ(candidates_at(38), candidates_at(42) + 1);
}

/// Under noise that hides the surface's own normals: with full weight, with a tenth of it, and not at all.
TEST(FitWeightSearch, DirectionsFarFromTheNormalsGetLess) {
  Search search(Solved("sphere", 40, 1, {.noise_vox = 0.9, .viewing = false}));
  const GridSamples exact = search.samples;
  const auto steps_at = [&](double degrees) {
    search.samples = tilted(exact, degrees);
    const FitWeights found = search.choose({});
    EXPECT_TRUE(found.edge_preserving);
    EXPECT_NEAR(search.report.agreement_deg, degrees, 1);
    return std::log(found.normals / 0.05) / std::log(4);  // by factors of 4 from the first weight
  };
  const auto to_whole = [](double x) { return std::abs(x - std::round(x)); };
  EXPECT_LT(to_whole(steps_at(10)), 1e-6);
  for (const double degrees : {25, 35}) EXPECT_LT(to_whole(steps_at(degrees) + std::log(10) / std::log(4)), 1e-6);
  EXPECT_TRUE(std::isinf(steps_at(45))) << "weight 0";
}

TEST(FitWeightSearch, FindsTheNoiseAndNoDetailBelowIt) {
  for (const double noise : {0.02, 0.3, 0.6}) {
    Search search(Solved("sphere", 40, 1, {.noise_vox = noise, .viewing = false}));
    const FitWeights found = search.choose({});
    EXPECT_NEAR(found.noise, noise, 0.06 * noise);
    EXPECT_EQ(found.edge_preserving, noise > 0.1);
    EXPECT_GE(found.smoothing, std::pow(1.3 * noise, 4));
  }
}

TEST(FitWeightSearch, KeepsTheWeightsThatAreGiven) {
  Search search(Solved("sphere", 40, 1, {.noise_vox = 0.05, .viewing = false}));
  search.samples = tilted(search.samples, 30);  // which would not be used
  const FitWeights both = search.choose({.smoothing = 0.7, .normals = 0.3});
  EXPECT_EQ(both.smoothing, 0.7);
  EXPECT_EQ(both.normals, 0.3);
  EXPECT_EQ(search.report.candidates, 1);
  EXPECT_EQ(search.choose({.smoothing = 150}).smoothing, 150);
  EXPECT_EQ(search.choose({.normals = 0.3}).normals, 0.3);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
