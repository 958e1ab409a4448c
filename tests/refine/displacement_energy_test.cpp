#include <gtest/gtest.h>

#include <cmath>

#include "refine/dense_energy.h"
#include "soapfilm/core/median.h"
#include "soapfilm/refine/fit/displacement.h"
#include "soapfilm/refine/fit/multilevel.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// A wavy sheet among samples that contradict each other.
class DisplacementEnergy : public testing::Test {
 protected:
  NarrowBand band = sheet_band(2.5, 0.03, 1);
  DenseBand dense{band};
  GridSamples samples = random_samples(2, 6000, 2);
  RowArray phi0 = [&] {
    RowArray values = random_array(band, 3);
    for (size_t i = 0; i < dense.size(); ++i) {
      const Vec3d q(dense.vertex[i]);
      float& value = values.data()[dense.slot[i]];
      value = static_cast<float>(sheet_distance(q) + 0.4 * std::sin(0.7 * q.x) * std::cos(0.5 * q.y)) + 0.1f * value;
    }
    return values;
  }();
  CellSamples data{samples, band, one_thread};
  DenseEnergy energy{dense, phi0};

  void merge_with(DataWeights weights) { merge(phi0, samples, band, {}, weights, one_thread, data); }

  static double largest(const Values& a, const Values& b) {
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
  }
  void expect_minimum(Displacement& displacement, Smoothness smoothness) {
    displacement.precondition(data, smoothness);
    displacement.minimize(data, smoothness, {300, 1e-5});
    const Values expected = energy.quadratic(data, smoothness).minimizer();
    ASSERT_FALSE(expected.empty());
    const double moved = largest(expected, energy.start);
    EXPECT_GT(moved, 0.2);
    EXPECT_LT(largest(dense.values(displacement.phi()), expected), 3e-4 * moved)
        << "gamma " << smoothness.curvature << ", beta " << smoothness.slope;
  }
};

TEST_F(DisplacementEnergy, IsMinimizedAsByADenseSolver) {
  for (const DataWeights weights : {DataWeights{}, {0.3f, 0.9f}})
    for (const Smoothness smoothness : {Smoothness{0.02f, 0.05f}, {0.5f, 2}}) {
      merge_with(weights);
      Displacement displacement(band, phi0, one_thread);
      expect_minimum(displacement, smoothness);
    }
}

/// Conjugate gradients: each step lowers the energy, and the tolerance ends them with the step that begins below it.
TEST_F(DisplacementEnergy, FallsWithEachStep) {
  merge_with({0.3f, 0.9f});
  const Smoothness smoothness{0.1f, 1};
  const Quadratic e = energy.quadratic(data, smoothness);
  const auto after = [&](SolveLimits limits, int steps) {
    Displacement displacement(band, phi0, one_thread);
    displacement.precondition(data, smoothness);
    EXPECT_EQ(displacement.minimize(data, smoothness, limits), steps);
    return e.at(dense.values(displacement.phi()));
  };
  double before = after({0, 0}, 0);
  for (int steps = 1; steps <= 8; ++steps) {
    const double now = after({steps, 0}, steps);
    EXPECT_LT(now, before) << steps;
    before = now;
  }
  EXPECT_EQ(after({8, 1}, 1), after({1, 0}, 1)) << "the first residual is as large as itself";
}

/// The weights s and the target from their definitions.
class Reweighted : public DisplacementEnergy {
 protected:
  DenseBand coarse{CoarseBand(band, one_thread).band()};

  /// (k1 - k2)^2 = 2 |D^2 phi|^2 - (laplacian phi)^2, 0 where one of the eighteen vertices around is missing.
  double squared_saddle(const Values& phi, size_t i) const {
    const Vec3i v = dense.vertex[i];
    std::array<std::array<double, 3>, 3> second{};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        double sum = 0;
        for (const int s : {-1, 1})
          for (const int t : {-1, 1}) {
            const auto there = a == b ? dense.find(v + along(a) * s) : dense.find(v + along(a) * s + along(b) * t);
            if (!there || dense.neighbors(i).size() < 6) return 0;
            sum += (a == b ? 0.5 * (phi[*there] - phi[i]) : 0.25 * s * t * phi[*there]);
          }
        second[static_cast<size_t>(a)][static_cast<size_t>(b)] = sum;
      }
    double squares = 0, trace = 0;
    for (size_t a = 0; a < 3; ++a) {
      trace += second[a][a];
      for (size_t b = 0; b < 3; ++b) squares += second[a][b] * second[a][b];
    }
    return std::max(0.0, 2 * squares - trace * trace);
  }

  void reweight(const Values& phi, double medians) {
    Values weight(dense.size()), product(dense.size()), c = dense.graph_laplacian(phi);
    std::vector<bool> inside(dense.size());
    for (size_t i = 0; i < dense.size(); ++i) {
      c[i] = -c[i];
      inside[i] = dense.neighbors(i).size() == 6;
      weight[i] = inside[i] && std::abs(phi[i]) < 1 ? 1 : 1e-6;
      if (inside[i])
        product[i] = weight[i] * ((c[i] - energy.target[i]) * (c[i] - energy.target[i]) + squared_saddle(phi, i));
    }
    const Values mean = slow_local_mean(dense, coarse, product, weight);
    Values near;
    for (size_t i = 0; i < dense.size(); ++i)
      if (inside[i] && std::abs(energy.start[i]) < 1) near.push_back(mean[i]);
    const double d0 = medians * medians * median(near);
    for (size_t i = 0; i < dense.size(); ++i) {
      const double beyond = std::max(0.0, std::abs(energy.start[i]) - 0.5);
      energy.share[i] = inside[i] ? 1 / (1 + mean[i] / d0) / (1 + beyond * beyond) : 1;
      weight[i] *= energy.share[i];
      product[i] = inside[i] ? weight[i] * c[i] : 0;
    }
    energy.target = slow_local_mean(dense, coarse, product, weight);
    for (size_t i = 0; i < dense.size(); ++i) energy.target[i] = inside[i] ? 0.6 * energy.target[i] : 0;
  }
};

TEST_F(Reweighted, EnergyIsMinimizedAsByADenseSolver) {
  merge_with({0.1f, 0.4f});
  const Smoothness smoothness{0.05f, 4};
  Displacement displacement(band, phi0, one_thread);
  displacement.precondition(data, smoothness);
  for (const double medians : {1.2, 0.5}) {
    displacement.minimize(data, smoothness, {3, 0});
    reweight(dense.values(displacement.phi()), medians);
    displacement.reweight_curvature(medians);
    expect_minimum(displacement, smoothness);
  }
  energy.target.assign(dense.size(), 0);
  displacement.drop_target();
  expect_minimum(displacement, smoothness);
  energy.share.assign(dense.size(), 1);
  displacement.reweight_curvature(1);
  displacement.reset_curvature_weights();
  expect_minimum(displacement, smoothness);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
