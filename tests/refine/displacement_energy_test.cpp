#include <gtest/gtest.h>

#include <cmath>

#include "refine/dense_band.h"
#include "soapfilm/core/median.h"
#include "soapfilm/refine/displacement.h"
#include "soapfilm/refine/multilevel.h"
#include "support/dense_matrix.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// The energy of Displacement on a small band, every term from its definition.
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
  Values start = dense.values(phi0);
  CellSamples data{samples, band, one_thread};
  Values share = Values(dense.size(), 1), target = Values(dense.size());

  void merge_with(DataWeights weights) { merge(phi0, samples, band, {}, weights, one_thread, data); }

  /// A corner's share in the value and in the gradient at a place in a cell.
  struct Corner {
    size_t index;
    double value;
    Vec3d gradient;
  };
  std::vector<Corner> corners_of(size_t row, int x, Vec3d at) const {
    std::vector<Corner> corners;
    const size_t first = size_t{data.band_row(row)} * brick_side + static_cast<size_t>(x);
    const auto lowest = std::find(dense.slot.begin(), dense.slot.end(), first) - dense.slot.begin();
    for (int k = 0; k < 8; ++k) {
      const Vec3i c{k & 1, k >> 1 & 1, k >> 2};
      Vec3d part, slope;
      for (int axis = 0; axis < 3; ++axis) {
        part[axis] = c[axis] ? at[axis] : 1 - at[axis];
        slope[axis] = c[axis] ? 1 : -1;
      }
      corners.push_back({dense.find(dense.vertex[static_cast<size_t>(lowest)] + c).value(),
                         part.x * part.y * part.z,
                         {slope.x * part.y * part.z, part.x * slope.y * part.z, part.x * part.y * slope.z}});
    }
    return corners;
  }

  /// E = <phi, A phi> - 2 <b, phi> + a constant.
  struct Quadratic {
    DenseMatrix a;
    Values b;
  };
  /// weight (f - wanted)^2, f linear in phi.
  static void add(Quadratic& e, const std::vector<size_t>& index, const Values& f, double wanted, double weight) {
    e.a.add_square(index, f, weight);
    for (size_t k = 0; k < index.size(); ++k) e.b[index[k]] += weight * wanted * f[k];
  }
  void add_data(Quadratic& e) const {
    for (size_t row = 0; row < data.rows(); ++row)
      for (int x = 0; x < brick_side; ++x) {
        if ((data.present(row) >> x & 1) == 0) continue;
        const MergedCell cell = data.cell(row, x);
        const Vec3d n(cell.normal);
        const auto corners = corners_of(row, x, Vec3d(cell.fraction));
        std::vector<size_t> index;
        Values value, along;
        std::array<Values, 3> slope;
        for (const Corner& c : corners) {
          index.push_back(c.index);
          value.push_back(c.value);
          along.push_back(dot(n, c.gradient));
          for (int axis = 0; axis < 3; ++axis) slope[static_cast<size_t>(axis)].push_back(c.gradient[axis]);
        }
        const double weight = cell.weight, normal = data.weights.normal, steepness = data.weights.slope;
        add(e, index, value, 0, weight);
        for (int axis = 0; axis < 3; ++axis) add(e, index, slope[static_cast<size_t>(axis)], -n[axis], weight * normal);
        add(e, index, along, -dot(n, n), weight * (steepness - normal));
      }
  }
  /// Of delta = phi - phi0.
  void add_smoothness(Quadratic& e, Smoothness smoothness) const {
    const Values k = dense.inner_laplacian(start), g = dense.graph_laplacian(start);
    for (size_t i = 0; i < dense.size(); ++i) {
      std::vector<size_t> index{i};
      Values bend{0};
      for (const size_t j : dense.neighbors(i)) {
        bend[0] += 1;
        bend.push_back(-1);
        index.push_back(j);
        if (j > i) add(e, {i, j}, {1, -1}, start[i] - start[j], smoothness.slope);
      }
      add(e, index, bend, g[i] + k[i] - target[i], smoothness.curvature * share[i]);
    }
  }
  Quadratic energy(Smoothness smoothness) const {
    Quadratic e{DenseMatrix(dense.size()), Values(dense.size())};
    add_data(e);
    add_smoothness(e, smoothness);
    return e;
  }

  static double largest(const Values& a, const Values& b) {
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
  }
  void expect_minimum(Displacement& displacement, Smoothness smoothness) {
    displacement.precondition(data, smoothness);
    displacement.minimize(data, smoothness, {300, 1e-5});
    Quadratic e = energy(smoothness);
    ASSERT_TRUE(e.a.factorize());
    const Values expected = e.a.solve(e.b);
    const double moved = largest(expected, start);
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
  const Quadratic e = energy(smoothness);
  const auto after = [&](SolveLimits limits, int steps) {
    Displacement displacement(band, phi0, one_thread);
    displacement.precondition(data, smoothness);
    EXPECT_EQ(displacement.minimize(data, smoothness, limits), steps);
    const Values phi = dense.values(displacement.phi()), product = e.a.times(phi);
    double sum = 0;
    for (size_t i = 0; i < phi.size(); ++i) sum += phi[i] * (product[i] - 2 * e.b[i]);
    return sum;
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
      if (inside[i]) product[i] = weight[i] * ((c[i] - target[i]) * (c[i] - target[i]) + squared_saddle(phi, i));
    }
    const Values mean = slow_local_mean(dense, coarse, product, weight);
    Values near;
    for (size_t i = 0; i < dense.size(); ++i)
      if (inside[i] && std::abs(start[i]) < 1) near.push_back(mean[i]);
    const double d0 = medians * medians * median(near);
    for (size_t i = 0; i < dense.size(); ++i) {
      const double beyond = std::max(0.0, std::abs(start[i]) - 0.5);
      share[i] = inside[i] ? 1 / (1 + mean[i] / d0) / (1 + beyond * beyond) : 1;
      weight[i] *= share[i];
      product[i] = inside[i] ? weight[i] * c[i] : 0;
    }
    target = slow_local_mean(dense, coarse, product, weight);
    for (size_t i = 0; i < dense.size(); ++i) target[i] = inside[i] ? 0.6 * target[i] : 0;
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
  target.assign(dense.size(), 0);
  displacement.drop_target();
  expect_minimum(displacement, smoothness);
  share.assign(dense.size(), 1);
  displacement.reweight_curvature(1);
  displacement.reset_curvature_weights();
  expect_minimum(displacement, smoothness);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
