#include "soapfilm/refine/fit/displacement.h"

#include <gtest/gtest.h>

#include "refine/band_support.h"
#include "support/back_ends.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// A ball of radius 9 in 4^3 bricks: its distance within 2.5 voxels, displaced, and samples of the true one.
class BallDisplacement : public testing::Test {
 protected:
  static double distance(Vec3d q) { return 9 - norm(q - Vec3d{15.3, 16.1, 15.8}); }

  NarrowBand band = [] {
    BrickGrid grid(BrickMask::whole({4, 4, 4}), one_thread);
    std::vector<uint8_t> vertices(grid.size() * brick_area);
    for (size_t b = 0; b < grid.size(); ++b)
      for_each_vertex(grid.coord(b), [&](Vec3i v, int i) {
        if (std::abs(distance(Vec3d(v))) < 2.5)
          vertices[b * brick_area + static_cast<size_t>(i / 8)] |= static_cast<uint8_t>(1 << (i % 8));
      });
    return NarrowBand(std::move(grid), vertices, one_thread);
  }();
  GridSamples samples = random_samples(4, 60000, 3);
  RowArray phi0 = band.make_array();
  CellSamples data;

  CellSamples fitted(float gamma) {
    std::vector<uint8_t> near(samples.size());
    for (size_t b = 0; b < samples.bricks.size(); ++b)
      for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
        const Vec3d q = Vec3d(samples.bricks.first_vertex(b)) + Vec3d(samples.local[s]);
        near[s] = std::abs(distance(q)) < 0.3;
        samples.direction[s] = Vec3f(normalized(q - Vec3d{15.3, 16.1, 15.8}));
      }
    CellSamples cells(samples, band, one_thread);
    merge(phi0, samples, band, {.active = near}, {0, 2 * gamma}, one_thread, cells);
    return cells;
  }
  void displace() {
    for (size_t b = 0; b < band.grid().size(); ++b)
      for_each_vertex(band.grid().coord(b), [&](Vec3i v, int i) {
        const uint32_t row = band.row(static_cast<int32_t>(b), i >> 3 & 7, i >> 6);
        if (band.mask(row) >> (i & 7) & 1)
          phi0.data()[row * brick_side + static_cast<size_t>(i & 7)] =
              static_cast<float>(distance(Vec3d(v)) + 0.5 * std::sin(0.4 * v.x) * std::cos(0.5 * v.y));
      });
  }
  /// The largest change by solving on to `more` steps, over the largest displacement.
  double left_after(int steps, float gamma) {
    displace();
    const CellSamples cells = fitted(gamma);
    const Smoothness smoothness{0.02f * std::sqrt(gamma), gamma};
    Displacement few(band, phi0, one_thread), many(band, phi0, one_thread);
    for (Displacement* displacement : {&few, &many}) displacement->precondition(cells, smoothness);
    few.minimize(cells, smoothness, {steps, 0});
    many.minimize(cells, smoothness, {200, 1e-6});
    double change = 0, all = 0;
    for (size_t i = 0; i < phi0.size(); ++i) {
      change = std::max(change, std::abs(static_cast<double>(few.phi().data()[i]) - many.phi().data()[i]));
      all = std::max(all, std::abs(static_cast<double>(many.phi().data()[i]) - phi0.data()[i]));
    }
    return change / all;
  }
};

TEST_F(BallDisplacement, TwelveStepsConvergeForAnySmoothness) {
  for (const float gamma : {0.01f, 1.0f, 200.0f}) EXPECT_LT(left_after(12, gamma), 0.02) << "gamma " << gamma;
}

TEST_F(BallDisplacement, APreconditionerOfOtherWeightsConverges) {
  displace();
  CellSamples cells = fitted(1);
  const Smoothness smoothness{0.02f, 1};
  Displacement few(band, phi0, one_thread), many(band, phi0, one_thread);
  few.precondition(cells, smoothness);
  // A third of the samples turn out to be half as good.
  for (size_t k = 0; k < cells.rows(); k += 3)
    for (int x = 0; x < brick_side; ++x)
      if (cells.present(k) >> x & 1) cells.set_weight(k, x, 0.5f * cells.cell(k, x).weight);
  few.minimize(cells, smoothness, {12, 0});
  many.precondition(cells, smoothness);
  many.minimize(cells, smoothness, {200, 1e-6});
  double change = 0;
  for (size_t i = 0; i < phi0.size(); ++i)
    change = std::max(change, std::abs(static_cast<double>(few.phi().data()[i]) - many.phi().data()[i]));
  EXPECT_LT(change, 0.01) << "of 0.5 voxel";
}

class BallDisplacementOn : public BallDisplacement, public testing::WithParamInterface<BackEnd> {};

TEST_P(BallDisplacementOn, GivesTheSameBits) {
  displace();
  const CellSamples cells = fitted(0.5f);
  const auto run = [&](const Context& context) {
    Displacement displacement(band, phi0, context);
    displacement.precondition(cells, {0.02f, 0.5f});
    for (int round = 0; round < 2; ++round) {
      displacement.minimize(cells, {0.02f, 0.5f}, {2, 0});
      displacement.reweight_curvature(1);
    }
    displacement.minimize(cells, {0.02f, 0.5f}, {2, 0});
    return std::vector<float>(displacement.phi().data(), displacement.phi().data() + displacement.phi().size());
  };
  const std::vector<float> expected = run(one_thread);
  EXPECT_EQ(run(context_on(GetParam())), expected);
}

/// Of 26 layers of bricks two and three threads process several slabs in every pass.
TEST(Displacement, GivesTheSameBitsInSlabsOfLayers) {
  constexpr Vec3i bricks{2, 2, 26};
  const NarrowBand band = random_band(bricks, 0.97, 1);
  const RowArray phi0 = random_array(band, 2);
  const GridSamples samples = random_samples(bricks, 20000, 3);
  const auto run = [&](int threads) { return fitted_twice(band, phi0, samples, 2, Context(threads)); };
  const std::vector<float> expected = run(1);
  EXPECT_NE(expected, std::vector<float>(phi0.data(), phi0.data() + phi0.size()));
  for (const int threads : {2, 3}) EXPECT_EQ(run(threads), expected) << threads << " threads";
}

INSTANTIATE_TEST_SUITE_P(BackEnds, BallDisplacementOn, testing::ValuesIn(back_ends()), back_end_name);

}  // namespace TEST_FILE
}  // namespace soapfilm
