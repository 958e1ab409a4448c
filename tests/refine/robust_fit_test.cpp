#include "soapfilm/refine/fit/robust_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/dense_energy.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// Samples on a sheet, seen from outside, a fifth of them up to two voxels off on one side; the start waves around it.
class RobustSheet : public testing::Test {
 protected:
  NarrowBand band = sheet_band(2.5, 0, 1);
  DenseBand dense{band};
  GridSamples samples = [] {
    GridSamples found = random_samples(2, 20000, 2);
    Random random(3);
    const Vec3f normal{0.36f, 0.48f, 0.8f};
    for (size_t b = 0; b < found.bricks.size(); ++b)
      for (uint32_t s = found.begin[b]; s < found.begin[b + 1]; ++s) {
        Vec3f& local = found.local[s];
        const Vec3d at = Vec3d(found.bricks.first_vertex(b)) + Vec3d(local);
        const double off = random.uniform() < 0.2 ? random.uniform(0, 2) : 0.05 * random.normal();
        // Moved onto the sheet along its normal if that leaves it in its brick; else it lies outside the band.
        const Vec3f moved = local - static_cast<float>(sheet_distance(at) - off) * normal;
        if (std::abs(sheet_distance(at)) < 3 && std::min({moved.x, moved.y, moved.z}) >= 0 &&
            std::max({moved.x, moved.y, moved.z}) < brick_side)
          local = moved;
        found.direction[s] = -normal;
      }
    return found;
  }();
  RowArray phi0 = [&] {
    Values values;
    for (const Vec3i v : dense.vertex)
      values.push_back(sheet_distance(Vec3d(v)) + 0.2 * std::sin(0.5 * v.x) * std::cos(0.6 * v.y));
    return dense.array(band, values);
  }();
  CellSamples cells{samples, band, one_thread};

  struct Outcome {
    Values phi;
    RobustFit fit;
  };
  Outcome fitted(const FitWeights& weights, const RobustParams& params, const GridSamples& from,
                 std::span<const uint8_t> active = {}) {
    Displacement displacement(band, phi0, one_thread);
    CellSamples memory(from, band, one_thread);
    const RobustFit fit = fit_robustly(displacement, from, memory, active, weights, params, one_thread);
    return {dense.values(displacement.phi()), fit};
  }
  Outcome fitted(const FitWeights& weights, const RobustParams& params, std::span<const uint8_t> active = {}) {
    return fitted(weights, params, samples, active);
  }
};

void expect_near(const Values& found, const Values& expected, double tolerance) {
  double error = 0;
  for (size_t i = 0; i < expected.size(); ++i) error = std::max(error, std::abs(found[i] - expected[i]));
  EXPECT_LT(error, tolerance);
}

/// Solved well in each round, the fit is a sequence of dense solutions: the penalty's scale is halved from first_scale
/// until it is that of the noise, and the samples are weighted by their distances from the last solution.
TEST_F(RobustSheet, IsWeightingAndSolvingInTurn) {
  RobustParams params;
  params.rounds = 4;
  params.solve = {600, 1e-5};
  for (const auto& [noise, normals, first_scale, rounds] :
       {std::tuple{0.05, 0.0, 0.6, 4}, {0.12, 0.2, 0.5, 2}, {0.01, 5.0, 0.0, 2}}) {
    params.first_scale = first_scale;
    const FitWeights weights{0.3, normals, noise, false};
    DenseEnergy energy(dense, phi0);
    const Smoothness smoothness{static_cast<float>(0.02 * std::sqrt(0.3)), 0.3f};
    Values phi = energy.start;
    size_t doubted = 0;
    for (int round = 0; round < rounds; ++round) {
      const double scale = std::max({0.1, 2.5 * noise, first_scale * std::pow(0.5, round)});
      merge(dense.array(band, phi), samples, band, {Penalty::tukey, static_cast<float>(scale), normals > 0, {}},
            {static_cast<float>(normals), static_cast<float>(std::max(2 * 0.3, normals))}, one_thread, cells);
      doubted = cells.doubted;
      phi = energy.quadratic(cells, smoothness).minimizer();
    }
    const Outcome found = fitted(weights, params);
    EXPECT_EQ(found.fit.down_weighted, doubted);
    expect_near(found.phi, phi, 1e-4);
  }
}

TEST_F(RobustSheet, OutliersPullLeastSquaresAlone) {
  const auto off_sheet = [&](Penalty penalty) {
    RobustParams params;
    params.penalty = penalty;
    const Outcome found = fitted({0.3, 0, 0.05, false}, params);
    double sum = 0, count = 0;
    for (size_t i = 0; i < dense.size(); ++i)
      if (const double d = sheet_distance(Vec3d(dense.vertex[i])); std::abs(d) < 1) sum += found.phi[i] - d, ++count;
    return sum / count;
  };
  EXPECT_GT(std::abs(off_sheet(Penalty::least_squares)), 0.05);
  EXPECT_LT(std::abs(off_sheet(Penalty::tukey)), 0.02);
}

TEST_F(RobustSheet, TakesTheIterationsThatItsParametersSay) {
  RobustParams params;
  params.solve = {12, 0};
  params.rounds = 3;
  params.first_scale = 0.5;
  EXPECT_EQ(fitted({0.3, 0, 0.01, false}, params).fit.iterations, 3 + 2 + 12);
  EXPECT_EQ(fitted({0.3, 0, 0.2, false}, params).fit.iterations, 3 + 12)
      << "the first scale is already that of the noise";
  params.reweighting_steps = {2, 5, 1};
  EXPECT_EQ(fitted({0.3, 0, 0.01, true}, params).fit.iterations, 2 + 5 + 1);
}

/// With edge-preserving reweighting: by the steps of its description. A second fit starts from the first one's weights
/// of the curvature, without its target.
TEST_F(RobustSheet, ReweightsTheCurvatureBetweenRounds) {
  RobustParams params;
  params.reweighting_steps = {2, 3, 4};
  for (const double normals : {0.0, 0.3}) {
    Displacement steps(band, phi0, one_thread), whole(band, phi0, one_thread);
    const Smoothness smoothness{static_cast<float>(0.02 * std::sqrt(0.5)), 0.5f};
    const double steepness = 0.5 * (normals > 0 ? params.slope_along_directions : params.slope);
    for (int fit = 0; fit < 2; ++fit) {
      steps.drop_target();
      for (int round = 0; round < 3; ++round) {
        if (round > 0) steps.reweight_curvature(params.reweighting_threshold);
        const double scale = std::max(2.5 * 0.08, params.first_scale * std::pow(0.5, round));
        merge(steps.phi(), samples, band, {Penalty::tukey, static_cast<float>(scale), normals > 0, {}},
              {static_cast<float>(normals), static_cast<float>(steepness)}, one_thread, cells);
        if (round == 0) steps.precondition(cells, smoothness);
        const int iterations = params.reweighting_steps[static_cast<size_t>(round)];
        steps.minimize(cells, smoothness, {iterations, params.solve.tolerance});
      }
      fit_robustly(whole, samples, cells, {}, {0.5, normals, 0.08, true}, params, one_thread);
      EXPECT_EQ(dense.values(whole.phi()), dense.values(steps.phi()));
    }
  }
}

TEST_F(RobustSheet, WhatIsNotActiveHasNoEffect) {
  std::vector<uint8_t> active(samples.size());
  for (size_t s = 0; s < active.size(); ++s) active[s] = s % 4 != 0;
  GridSamples other = samples;
  for (size_t s = 0; s < active.size(); ++s)
    if (!active[s]) other.direction[s] = {1, 0, 0};
  for (const bool edges : {false, true}) {
    const FitWeights weights{0.3, 0.2, 0.05, edges};
    const Values expected = fitted(weights, {}, active).phi;
    EXPECT_EQ(fitted(weights, {}, other, active).phi, expected);
    EXPECT_NE(fitted(weights, {}).phi, expected);
  }
}

TEST_F(RobustSheet, DownWeightsWhatLiesFarOffOrOutside) {
  RobustParams params;
  params.rounds = 1;
  params.first_scale = 0.4;
  const auto jets = jets_at_samples(phi0, samples, cells, band, one_thread);
  size_t expected = 0;
  for (size_t s = 0; s < samples.size(); ++s) {
    const double distance =
        jets[s] ? std::abs(jets[s]->value) / std::max(norm(jets[s]->gradient), least_slope_of_distance) : 0;
    const double share = std::max(0.0, 1 - std::pow(distance / (4.685 * 0.4), 2));
    expected += !jets[s] || share * share < 0.25;
  }
  EXPECT_EQ(fitted({0.3, 0, 0.01, false}, params).fit.down_weighted, expected);
}

TEST(FitWeights, OfTheSameSurfaceOnAGridTwiceAsFine) {
  // Squared distances are four times as large, slopes are the same, second differences half as large at four times as
  // many vertices.
  const FitWeights fine = on_half_the_voxel({0.3, 0.2, 0.1, true});
  EXPECT_DOUBLE_EQ(fine.smoothing, 1.2);
  EXPECT_DOUBLE_EQ(fine.normals, 0.8);
  EXPECT_DOUBLE_EQ(fine.noise, 0.2);
  EXPECT_TRUE(fine.edge_preserving);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
