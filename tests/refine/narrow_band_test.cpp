#include "soapfilm/refine/fit/narrow_band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "refine/band_support.h"
#include "soapfilm/refine/fit/multilevel.h"
#include "support/back_ends.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);
const auto nothing_to_complete = [](int) {};

Dense<double> dense(const NarrowBand& band, const RowArray& array) {
  Dense<double> values(band.grid().bricks() * brick_side);
  for (size_t b = 0; b < band.grid().size(); ++b)
    for_each_vertex(band.grid().coord(b), [&](Vec3i v, int i) {
      const uint32_t row = band.row(static_cast<int32_t>(b), i >> 3 & 7, i >> 6);
      values[v] = static_cast<double>(array.data()[row * brick_side + static_cast<size_t>(i & 7)]);
    });
  return values;
}

/// 1 on the band.
RowArray members(const NarrowBand& band) {
  RowArray ones = band.make_array();
  for (size_t i = 0; i < ones.size(); ++i)
    ones.data()[i] = static_cast<float>(band.mask(static_cast<uint32_t>(i / 8)) >> (i % 8) & 1);
  return ones;
}

/// Layers are numbered without most of the empty ones: neighbors in number are neighbors or farther apart, and parity
/// is that of z, so that passes over even and then odd layers add in the same order wherever other bricks lie.
TEST(BandLayers, KeepParityAndOrderAndLeaveOutEmptyOnes) {
  Random random(9);
  for (int k = 0; k < 50; ++k) {
    const int far = k % 2 == 0 ? 40 : 1'000'000;
    BrickMask mask({4, 4, far});
    for (int n = 0; n < 12; ++n)
      mask.set({static_cast<int>(random.next() % 4), static_cast<int>(random.next() % 4),
                static_cast<int>(random.next() % static_cast<uint64_t>(far))});
    const BrickGrid grid(mask, one_thread);
    const BandLayers layers(grid);
    EXPECT_LE(layers.size(), 2 * static_cast<int>(grid.slices().size()));
    size_t next = 0;
    for (int layer = 0; layer < layers.size(); ++layer) {
      const auto [begin, end] = layers[layer];
      EXPECT_EQ(begin, next);
      next = end;
      EXPECT_EQ((layers.z(layer) - layer) % 2, 0);
      if (layer > 0) {
        EXPECT_GT(layers.z(layer), layers.z(layer - 1));
      }
      for (size_t b = begin; b < end; ++b) EXPECT_EQ(grid.coord(b).z, layers.z(layer));
    }
    EXPECT_EQ(next, grid.size());
  }
}

TEST(NarrowBand, LaplacianIsTheDenseGraphLaplacian) {
  const NarrowBand band = random_band(3, 0.6, 1);
  RowArray out = band.make_array();
  const RowArray v = random_array(band, 2);
  apply_laplacian(band, v, 0.5f, 2, out, one_thread);
  const Dense<double> in_band = dense(band, members(band)), values = dense(band, v), result = dense(band, out);
  in_band.for_each([&](Vec3i at) {
    if (in_band[at] == 0) return;
    double sum = 0, degree = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const Vec3i next : {at + along(axis), at - along(axis)})
        if (in_band.get(next) > 0) sum += values[at] - values[next], ++degree;
    if (degree == 0) return;
    EXPECT_NEAR(result[at], 0.5 * values[at] + 2 * sum, 1e-5);
  });
}

TEST(NarrowBand, SaddlesAreTheDifferenceOfThePrincipalCurvatures) {
  const NarrowBand band = random_band(3, 0.95, 6);
  const Dense<double> in_band = dense(band, members(band));
  Random random(7);
  for (int turn = 0; turn < 5; ++turn) {
    const auto direction = [&] { return normalized(Vec3d{random.normal(), random.normal(), random.normal()}); };
    const Vec3d normal = direction(), first = normalized(cross(normal, direction())), second = cross(normal, first);
    const double k1 = 0.2 * random.normal(), k2 = 0.2 * random.normal();
    RowArray phi = band.make_array();
    for (size_t b = 0; b < band.grid().size(); ++b)
      for_each_vertex(band.grid().coord(b), [&](Vec3i v, int i) {
        const uint32_t row = band.row(static_cast<int32_t>(b), i >> 3 & 7, i >> 6);
        if ((band.mask(row) >> (i & 7) & 1) == 0) return;
        const Vec3d p = Vec3d{v.x - 12.0, v.y - 12.0, v.z - 12.0};
        const double along_first = dot(p, first), along_second = dot(p, second);
        phi.data()[row * brick_side + static_cast<size_t>(i & 7)] = static_cast<float>(
            dot(p, normal) + 0.5 * (k1 * along_first * along_first + k2 * along_second * along_second));
      });
    RowArray out = band.make_array();
    const RowArray weight = members(band);
    band.kernel().saddles(band.view(), {phi.data(), weight.data(), out.data()}, 1, band.rows() + 1);
    const Dense<double> result = dense(band, out);
    int known = 0;
    in_band.for_each([&](Vec3i at) {
      bool all = in_band[at] > 0;
      for (int a = 0; a < 3; ++a)
        for (int s : {-1, 1}) {
          all = all && in_band.get(at + along(a) * s) > 0;
          for (int t : {-1, 1}) all = all && in_band.get(at + along(a) * s + along((a + 1) % 3) * t) > 0;
        }
      known += all;
      EXPECT_NEAR(result[at], all ? (k1 - k2) * (k1 - k2) : 0, 1e-3);
    });
    EXPECT_GT(known, 500);
  }
}

TEST(NarrowBand, LaplacianIsSymmetricAndPositiveAndForgetsConstants) {
  const NarrowBand band = random_band(2, 0.7, 3);
  const RowArray a = random_array(band, 4), b = random_array(band, 5);
  RowArray ga = band.make_array(), gb = band.make_array();
  apply_laplacian(band, a, 0, 1, ga, one_thread);
  apply_laplacian(band, b, 0, 1, gb, one_thread);
  EXPECT_NEAR(dot(ga, b), dot(a, gb), 1e-4 * dot(a, ga));
  EXPECT_GT(dot(a, ga), 0);
  const double energy = 0.5 * dot(a, ga) + 2 * dot(ga, ga);
  EXPECT_NEAR(apply_laplacian(band, a, 0.5f, 2, gb, one_thread), energy, 1e-5 * energy);
  apply_laplacian(band, members(band), 0, 1, ga, one_thread);
  EXPECT_EQ(dot(ga, ga), 0);
}

TEST(NarrowBand, MultilevelTransfersAreAdjointAndKeepConstants) {
  const NarrowBand band = random_band(3, 0.3, 6);
  const CoarseBand coarse(band, one_thread);
  const RowArray fine = random_array(band, 7), up = random_array(coarse.band(), 8);
  RowArray down = coarse.band().make_array(), prolonged = band.make_array();
  coarse.restrict_to(fine, down, one_thread);
  const RowArray inverse = members(band), zero = band.make_array();
  CycleJob job{};
  job.inverse = inverse.data();
  job.b = zero.data();
  job.x = up.data();
  job.out = prolonged.data();
  for (int layer = 0; layer < 3; ++layer) coarse.prolong_onto(layer, band, job);
  EXPECT_NEAR(dot(down, up), dot(fine, prolonged), 1e-3);

  const RowArray constant = members(coarse.band());
  job.x = constant.data();
  job.b = fine.data();
  for (int layer = 0; layer < 3; ++layer) coarse.prolong_onto(layer, band, job);
  for (size_t i = 8; i < band.slots(); ++i) ASSERT_EQ(prolonged.data()[i], fine.data()[i] + inverse.data()[i]);
}

TEST(NarrowBand, MultilevelRestrictsTheResidualOfAJacobiStep) {
  const NarrowBand band = random_band(3, 0.4, 14);
  const CoarseBand coarse(band, one_thread);
  const RowArray b = random_array(band, 15);
  RowArray inverse = members(band), x = band.make_array(), out = band.make_array(), residual = band.make_array();
  RowArray extent = members(band), extended = band.make_array();
  RowArray expected = coarse.band().make_array(), restricted = coarse.band().make_array();
  // A vertex without neighbors is not coupled to others.
  for (size_t i = 0; i < x.size(); ++i) {
    inverse.data()[i] *= band.degree(0)[i] > 0 ? 0.1f : 0.0f;
    x.data()[i] = inverse.data()[i] * b.data()[i];
    extent.data()[i] *= static_cast<float>(1 + i % 3);
    extended.data()[i] = extent.data()[i] * x.data()[i];
  }
  for (const float* e : {static_cast<const float*>(nullptr), static_cast<const float*>(extent.data())}) {
    CycleJob job{inverse.data(), e, b.data(), 0.7f, 0.8f, x.data(), out.data(), nullptr};
    job.extended = extended.data();
    band.kernel().smooth(band.view(), job, 1, band.rows() + 1);
    for (size_t i = 0; i < x.size(); ++i)
      residual.data()[i] = inverse.data()[i] > 0 ? (out.data()[i] - x.data()[i]) / inverse.data()[i] : 0.0f;
    coarse.restrict_to(residual, expected, one_thread);
    std::fill_n(restricted.data(), restricted.size(), 0.0f);
    for (int layer = 0; layer < 3; ++layer) coarse.restrict_residual(layer, band, job, restricted);
    for (size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(restricted.data()[i], expected.data()[i], 2e-5);
  }
}

/// Steps of uniform length, of K x = reaction x + diffusion G x, for the vertices that have neighbors.
TEST(NarrowBand, MultilevelTakesEvenSteps) {
  constexpr float step = 0.2f, reaction = 0.3f, diffusion = 0.7f;
  const NarrowBand band = random_band(3, 0.4, 17);
  const CoarseBand coarse(band, one_thread);
  const RowArray b = random_array(band, 18), up = random_array(coarse.band(), 19), ones = members(band);
  RowArray x = band.make_array(), product = band.make_array(), residual = band.make_array(), out = band.make_array();
  RowArray inverse = band.make_array(), expected = coarse.band().make_array(), restricted = coarse.band().make_array();
  size_t alone = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const bool tied = band.degree(0)[i] > 0;
    alone += !tied && ones.data()[i] > 0;
    inverse.data()[i] = tied ? step : 0.0f;
    x.data()[i] = inverse.data()[i] * b.data()[i];
  }
  ASSERT_GT(alone, 0u);
  apply_laplacian(band, x, reaction, diffusion, product, one_thread);
  for (size_t i = 0; i < x.size(); ++i)
    residual.data()[i] = inverse.data()[i] > 0 ? b.data()[i] - product.data()[i] : 0.0f;
  CycleJob job{};
  job.b = b.data();
  job.diffusion = diffusion;
  job.x = x.data();
  job.out = out.data();
  job.weight = b.data();
  job.step = step;
  job.reaction = reaction;

  const double sum = band.kernel().smooth(band.view(), job, 1, band.rows() + 1);
  for (size_t i = 0; i < x.size(); ++i)
    ASSERT_NEAR(out.data()[i], x.data()[i] + step * residual.data()[i], 1e-6) << "vertex " << i;
  EXPECT_NEAR(sum, dot(out, b), 1e-5 * std::abs(sum));

  coarse.restrict_to(residual, expected, one_thread);
  for (int layer = 0; layer < 3; ++layer) coarse.restrict_residual(layer, band, job, restricted);
  for (size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(restricted.data()[i], expected.data()[i], 5e-6);

  RowArray by_inverse = band.make_array();
  job.x = up.data();
  for (int layer = 0; layer < 3; ++layer) coarse.prolong_onto(layer, band, job);
  job.inverse = inverse.data();
  job.out = by_inverse.data();
  for (int layer = 0; layer < 3; ++layer) coarse.prolong_onto(layer, band, job);
  for (size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out.data()[i], by_inverse.data()[i]);
}

TEST(NarrowBand, LocalMeansKeepConstantsAndLieWithinTheValues) {
  const NarrowBand band = random_band(3, 0.5, 21);
  Multilevel multilevel(band, one_thread);
  const RowArray weights = members(band), noise = random_array(band, 22);
  RowArray values = band.make_array(), where = members(band), mean = band.make_array();
  for (size_t i = 0; i < where.size(); i += 3) where.data()[i] = 0;
  for (size_t i = 0; i < values.size(); ++i) values.data()[i] = 3 * weights.data()[i];
  ASSERT_TRUE(multilevel.local_mean(nothing_to_complete, values, weights, where, 0.5f, mean, one_thread));
  for (size_t i = 8; i < band.slots(); ++i) ASSERT_NEAR(mean.data()[i], where.data()[i] > 0 ? 1.5f : 0.0f, 1e-5);
  ASSERT_TRUE(multilevel.local_mean(nothing_to_complete, noise, weights, weights, 1, mean, one_thread));
  const auto [least, most] = std::minmax_element(noise.data(), noise.data() + noise.size());
  for (size_t i = 8; i < band.slots(); ++i) {
    ASSERT_GE(mean.data()[i], std::min(*least, 0.0f));
    ASSERT_LE(mean.data()[i], std::max(*most, 0.0f));
  }
}

TEST(NarrowBand, MultilevelIsSymmetricPositiveDefinite) {
  const NarrowBand band = random_band(3, 0.5, 9);
  Multilevel multilevel(band, one_thread);
  const RowArray a = random_array(band, 10), b = random_array(band, 11);
  RowArray weights = band.make_array(), ma = band.make_array(), mb = band.make_array(), work = band.make_array();
  for (size_t i = 0; i < weights.size(); i += 3) weights.data()[i] = 0.5f;
  for (const float gamma : {0.1f, 3.0f}) {  // with the positions on the finest level, and without
    multilevel.set_operator(weights, 0.01f, gamma, one_thread);
    const double energy = multilevel.apply(nothing_to_complete, a, ma, work, one_thread);
    multilevel.apply(nothing_to_complete, b, mb, work, one_thread);
    EXPECT_GT(energy, 0);
    EXPECT_NEAR(dot(a, ma), energy, 1e-5 * energy) << "gamma " << gamma;
    EXPECT_NEAR(dot(ma, b), dot(a, mb), 1e-4 * energy) << "gamma " << gamma;
  }
}

class RowsOn : public testing::TestWithParam<BackEnd> {};

TEST_P(RowsOn, GiveTheSameBits) {
  const NarrowBand band = random_band(Vec3i{2, 2, 26}, 0.7, 12);  // several slabs for two and three threads
  const RowArray a = random_array(band, 13);
  RowArray weights = band.make_array();
  for (size_t i = 0; i < weights.size(); i += 3) weights.data()[i] = 0.5f;
  const auto run = [&](const Context& context, float gamma) {
    Multilevel multilevel(band, context);
    multilevel.set_operator(weights, 0.01f, gamma, context);
    RowArray out = band.make_array(), work = band.make_array(), next = band.make_array();
    const double first = multilevel.apply(nothing_to_complete, a, out, work, context);
    const double second = apply_laplacian(band, out, 0.3f, 2, next, context);
    return std::tuple(std::vector<float>(next.data(), next.data() + next.size()), first, second);
  };
  for (const float gamma : {0.03f, 3.0f}) {  // with the positions on the finest level, and without
    const auto expected = run(one_thread, gamma);
    EXPECT_EQ(run(context_on(GetParam()), gamma), expected) << "gamma " << gamma;
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, RowsOn, testing::ValuesIn(back_ends()), back_end_name);

}  // namespace TEST_FILE
}  // namespace soapfilm
