#include "soapfilm/refine/fit/multilevel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <set>

#include "refine/dense_band.h"
#include "support/dense_matrix.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);
const auto nothing_to_complete = [](int) {};

double dot(const Values& a, const Values& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }

void expect_near(const Values& found, const Values& expected, double relative) {
  double most = 0, error = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    most = std::max(most, std::abs(expected[i]));
    error = std::max(error, std::abs(found[i] - expected[i]));
  }
  EXPECT_GT(most, 0);
  EXPECT_LE(error, relative * most);
}

/// Random weights of the samples on a third of a band.
RowArray random_weights(const NarrowBand& band, double size, uint64_t seed) {
  RowArray weights = random_array(band, seed);
  for (size_t i = 0; i < weights.size(); ++i)
    weights.data()[i] = i % 3 == 0 ? static_cast<float>(size) * std::abs(weights.data()[i]) : 0.0f;
  return weights;
}

TEST(CoarseBand, HoldsTheVerticesOfTrilinearInterpolationAndNoOthers) {
  for (const double share : {0.002, 0.3}) {
    const NarrowBand band = random_band(3, share, 1);
    const DenseBand fine(band), coarse(CoarseBand(band, one_thread).band());
    std::set<size_t> used;
    for (const auto& s : DenseTransfer(fine, coarse).shares) used.insert(s.coarse);
    EXPECT_EQ(used.size(), coarse.size());
  }
}

TEST(CoarseBand, InterpolatesAndRestrictsAsTrilinearFunctions) {
  const NarrowBand band = random_band(3, 0.2, 2);
  const CoarseBand half(band, one_thread);
  const DenseBand fine(band), coarse(half.band());
  const DenseTransfer transfer(fine, coarse);
  const RowArray below = random_array(band, 3), above = random_array(half.band(), 4);
  RowArray down = half.band().make_array(), up = band.make_array();
  half.restrict_to(below, down, one_thread);
  expect_near(coarse.values(down), transfer.down(fine.values(below), coarse.size()), 1e-6);
  const RowArray everywhere = fine.array(band, Values(fine.size(), 1));
  CycleJob job{};
  job.inverse = everywhere.data();
  job.x = above.data();
  job.out = up.data();
  for (int layer = 0; layer < layers_of(band); ++layer) half.prolong_onto(layer, band, job);
  expect_near(fine.values(up), transfer.up(coarse.values(above), fine.size()), 1e-6);
}

TEST(LocalMean, IsThatOfTheSlowReference) {
  const NarrowBand band = sheet_band(2.5, 0.1, 5);
  const DenseBand fine(band), coarse(CoarseBand(band, one_thread).band());
  Multilevel multilevel(band, one_thread);
  const RowArray weights = random_weights(band, 1, 6), noise = random_array(band, 7), where = random_array(band, 8);
  RowArray values = band.make_array(), mean = band.make_array();
  // The values come into being when they are asked for.
  const auto complete = [&](int layer) {
    const auto [begin, end] = rows_of_layer(band, layer);
    for (size_t i = begin * brick_side; i < end * brick_side; ++i)
      values.data()[i] = weights.data()[i] * noise.data()[i];
  };
  ASSERT_TRUE(multilevel.local_mean(complete, values, weights, where, 0.7f, mean, one_thread));
  Values expected = slow_local_mean(fine, coarse, fine.values(values), fine.values(weights));
  const Values there = fine.values(where);
  for (size_t i = 0; i < expected.size(); ++i) expected[i] *= there[i] > 0 ? 0.7 : 0;
  expect_near(fine.values(mean), expected, 1e-5);
}

/// The cycle as its header describes it, vertex by vertex.
class SlowCycle {
 public:
  SlowCycle(const NarrowBand& band, const RowArray& position_weights, double beta, double gamma)
      : diffusion_(std::sqrt(gamma)), reaction_(0.5 * beta / diffusion_) {
    std::vector<std::unique_ptr<CoarseBand>> coarser;
    Values extent, weights;
    for (const NarrowBand* next = &band;;) {
      Level level{DenseBand(*next), {}, {}, {}};
      if (levels_.empty()) {
        extent.assign(level.band.size(), 1);
        weights = level.band.values(position_weights);
      } else {
        levels_.back().to_coarser.emplace(levels_.back().band, level.band);
        extent = levels_.back().to_coarser->down(extent, level.band.size());
        weights = levels_.back().to_coarser->down(weights, level.band.size());
      }
      const bool last = next->rows() <= 64;
      set_operator(level, extent, weights, last);
      if (!last) next = &coarser.emplace_back(std::make_unique<CoarseBand>(*next, one_thread))->band();
      levels_.push_back(std::move(level));
      if (last) return;
    }
  }

  size_t levels() const { return levels_.size(); }
  Values apply(const Values& r) const { return cycle(0, cycle(0, r)); }
  /// Of the finest level.
  Values product(const Values& x) const { return product(levels_[0], x); }
  bool is_even() const { return even_; }

 private:
  struct Level {
    DenseBand band;
    std::vector<std::vector<std::pair<size_t, double>>> coupling;  ///< neighbors with their w
    Values diagonal;
    std::optional<DenseTransfer> to_coarser;
    Values step{};  ///< of Jacobi
  };

  void set_operator(Level& level, const Values& extent, const Values& weights, bool last) {
    const double diffusion = diffusion_ / std::pow(4, levels_.size());
    if (levels_.empty()) {
      double sum = 0, count = 0;
      for (const double w : weights) sum += w, count += w > 0;
      even_ = !last && sum <= 2.25 * diffusion * diffusion * count;
    }
    const bool even = levels_.empty() && even_;
    for (size_t i = 0; i < level.band.size(); ++i) {
      double around = 0;
      auto& couplings = level.coupling.emplace_back();
      for (const size_t j : level.band.neighbors(i)) {
        couplings.push_back({j, 0.5 * diffusion * (extent[i] + extent[j])});
        around += couplings.back().second;
      }
      level.diagonal.push_back(around + (even ? 0 : std::sqrt(weights[i] * extent[i])) + reaction_ * extent[i]);
      level.step.push_back(couplings.empty() ? 0 : 0.8 / (even ? 6 * diffusion + reaction_ : level.diagonal[i]));
    }
  }
  static Values product(const Level& level, const Values& x) {
    Values out(x.size());
    for (size_t i = 0; i < x.size(); ++i) {
      out[i] = level.diagonal[i] * x[i];
      for (const auto& [j, w] : level.coupling[i]) out[i] -= w * x[j];
    }
    return out;
  }
  static Values residual(const Level& level, const Values& x, const Values& b) {
    Values out = product(level, x);
    for (size_t i = 0; i < x.size(); ++i) out[i] = level.step[i] > 0 ? b[i] - out[i] : 0;
    return out;
  }
  static void smooth(const Level& level, Values& x, const Values& b) {
    const Values left = residual(level, x, b);
    for (size_t i = 0; i < x.size(); ++i) x[i] += level.step[i] * left[i];
  }
  Values cycle(size_t k, const Values& b) const {
    const Level& level = levels_[k];
    Values x(b.size());
    smooth(level, x, b);
    if (!level.to_coarser) {
      for (int step = 0; step < 8; ++step) smooth(level, x, b);
      return x;
    }
    const Level& coarser = levels_[k + 1];
    const Values correction = level.to_coarser->up(
        cycle(k + 1, level.to_coarser->down(residual(level, x, b), coarser.band.size())), x.size());
    for (size_t i = 0; i < x.size(); ++i) x[i] += level.step[i] > 0 ? correction[i] : 0;
    smooth(level, x, b);
    return x;
  }

  double diffusion_, reaction_;
  bool even_ = false;
  std::vector<Level> levels_;
};

/// Bands of one, two and three levels or more, by the number of bricks along each axis.
class Preconditioner : public testing::TestWithParam<int> {
 protected:
  NarrowBand band = GetParam() == 0   ? random_band(1, 0.7, 9)
                    : GetParam() == 1 ? sheet_band(2.5, 0.1, 9)
                                      : random_band(GetParam(), 0.6, 9);
  DenseBand dense{band};
  Multilevel multilevel{band, one_thread};
  RowArray z = band.make_array(), work = band.make_array();

  Values applied(const Values& r) {
    const RowArray from = dense.array(band, r);
    const double energy = multilevel.apply(nothing_to_complete, from, z, work, one_thread);
    const Values found = dense.values(z);
    EXPECT_NEAR(energy, dot(r, found), 1e-5 * energy);
    return found;
  }
  Values random(uint64_t seed) const { return dense.values(random_array(band, seed)); }
};

TEST_P(Preconditioner, IsTheCycleOfTheSlowReference) {
  for (const double weight : {0.01, 4.0})
    for (const float beta : {0.0f, 0.3f}) {
      const float gamma = 0.7f;
      const RowArray weights = random_weights(band, weight, 10);
      multilevel.set_operator(weights, beta, gamma, one_thread);
      const SlowCycle slow(band, weights, beta, gamma);
      EXPECT_EQ(slow.levels(), GetParam() == 4 ? 4u : static_cast<size_t>(1 + GetParam()));
      EXPECT_EQ(slow.is_even(), slow.levels() > 1 && weight < 1);
      const Values r = random(11);
      expect_near(applied(r), slow.apply(r), 1e-5);
    }
}

TEST_P(Preconditioner, IsLinear) {
  multilevel.set_operator(random_weights(band, 1, 12), 0.1f, 0.5f, one_thread);
  const Values a = random(13), b = random(14), za = applied(a), zb = applied(b);
  Values both(a.size()), expected(a.size());
  for (size_t i = 0; i < a.size(); ++i) {
    both[i] = 2 * a[i] - 0.5 * b[i];
    expected[i] = 2 * za[i] - 0.5 * zb[i];
  }
  expect_near(applied(both), expected, 1e-5);
}

/// Of A x = b, A = K^2, K with the positions: the error falls with each cycle, as <e, A e>.
TEST_P(Preconditioner, LowersTheErrorInEachCycle) {
  constexpr float beta = 0.1f;
  for (const auto& [weight, gamma] : {std::pair{0.01, 0.05f}, {0.01, 3.0f}, {4.0, 0.05f}}) {
    const RowArray weights = random_weights(band, weight, 16);
    multilevel.set_operator(weights, beta, gamma, one_thread);
    const Values d = dense.values(weights);
    const auto root = [&, diffusion = std::sqrt(gamma)](const Values& x) {
      Values out = dense.graph_laplacian(x);
      for (size_t i = 0; i < x.size(); ++i)
        out[i] =
            dense.neighbors(i).empty() ? 0 : diffusion * out[i] + (std::sqrt(d[i]) + 0.5 * beta / diffusion) * x[i];
      return out;
    };
    Values error = random(17), k = root(error);
    double before = dot(k, k);
    for (int cycle = 0; cycle < 6; ++cycle) {
      const Values step = applied(root(k));
      for (size_t i = 0; i < error.size(); ++i) error[i] -= step[i];
      k = root(error);
      EXPECT_LT(dot(k, k), 0.85 * before) << "gamma " << gamma << ", weight " << weight << ", cycle " << cycle;
      before = dot(k, k);
    }
  }
}

class SmallPreconditioner : public Preconditioner {};

/// Every element of it where there are equations: a vertex without neighbors gets 0.
TEST_P(SmallPreconditioner, IsSymmetricAndPositiveDefiniteToRounding) {
  std::vector<size_t> tied;
  for (size_t i = 0; i < dense.size(); ++i)
    if (!dense.neighbors(i).empty()) tied.push_back(i);
  for (const double weight : {0.01, 4.0}) {
    multilevel.set_operator(random_weights(band, weight, 15), 0.1f, 0.7f, one_thread);
    DenseMatrix m(tied.size());
    for (size_t i = 0; i < tied.size(); ++i) {
      Values unit(dense.size());
      unit[tied[i]] = 1;
      const Values column = applied(unit);
      for (size_t j = 0; j < tied.size(); ++j) m[j][i] = column[tied[j]];
    }
    double most = 0, skew = 0;
    for (size_t i = 0; i < tied.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        most = std::max(most, m[i][i]);
        skew = std::max(skew, std::abs(m[i][j] - m[j][i]));
      }
    EXPECT_LT(skew, 1e-6 * most);
    EXPECT_TRUE(m.factorize());
  }
}

TEST(Multilevel, GivesTheSameBitsOnAnyNumberOfThreads) {
  const NarrowBand band = random_band(Vec3i{2, 2, 26}, 0.7, 18);  // several slabs for two and three threads
  const RowArray r = random_array(band, 19), weights = random_weights(band, 1, 20), noise = random_array(band, 21);
  const auto run = [&](int threads, float gamma) {
    const Context context(threads);
    Multilevel multilevel(band, context);
    multilevel.set_operator(weights, 0.01f, gamma, context);
    RowArray z = band.make_array(), work = band.make_array(), mean = band.make_array();
    const double energy = multilevel.apply(nothing_to_complete, r, z, work, context);
    multilevel.local_mean(nothing_to_complete, noise, weights, weights, 1, mean, context);
    std::vector<float> all(z.data(), z.data() + z.size());
    all.insert(all.end(), mean.data(), mean.data() + mean.size());
    return std::pair(all, energy);
  };
  for (const float gamma : {0.03f, 3.0f}) {  // with the positions on the finest level, and without
    const auto expected = run(1, gamma);
    for (const int threads : {2, 3, 7}) EXPECT_EQ(run(threads, gamma), expected) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Bands, Preconditioner, testing::Values(0, 1, 2, 4));
INSTANTIATE_TEST_SUITE_P(Bands, SmallPreconditioner, testing::Values(0, 1));

}  // namespace TEST_FILE
}  // namespace soapfilm
