#include "soapfilm/solve/energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/dense.h"
#include "support/hash.h"
#include "support/random_level.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// Sets u = 1 in some of the gaps.
void fill_some_inactive_bricks(RandomLevel& random, uint64_t seed) {
  Random choice(seed);
  for (size_t gap = 0; gap < random.level.grid.gaps(); ++gap) random.level.inside.set(gap, choice.uniform() < 0.5);
}

/// One vertex's part of the gap, by the definition.
double gap_at(Vec3i v, const Level& level, const Dense<double>& u, const Dense<double>& f, const DenseVectors& p) {
  const Vec3d g = gradient_at(u, v, level.box);
  const double variation = level.lambda * length(g, level.norm) - dot(vector_at(p, v), g);
  if (!level.box.is_free(v)) return variation;
  const double r = adjoint_at(p, v) - f[v];
  return variation + r * u[v] - std::min(0.0, r);
}

/// Where the vertex is in the band.
void expect_shown(const Field<float>& shown, Vec3i v, const Level& level, double local) {
  const int32_t brick = level.grid.find(brick_of(v));
  if (brick < 0) return;
  const float there = shown.brick(static_cast<size_t>(brick))[brick_offset(v.x & 7, v.y & 7, v.z & 7)];
  EXPECT_NEAR(there, local / level.lambda, 1e-6 * (1 + std::abs(local / level.lambda)));
}

class EnergyOfRandomLevels : public testing::TestWithParam<std::tuple<uint64_t, Norm, bool>> {
 protected:
  const uint64_t seed = std::get<0>(GetParam());
  const Norm norm = std::get<1>(GetParam());
  const bool open = std::get<2>(GetParam());
};

TEST_P(EnergyOfRandomLevels, AgreesWithBruteForceOnTheDenseGrid) {
  const RandomLevel random(seed, {.rim = RimFlux::zero, .norm = norm, .open = open});
  const Level& level = random.level;
  const Dense<double> f = dense_f(level);
  for (const std::optional<float> threshold : {std::optional<float>(), std::optional(0.3f), std::optional(0.5f)}) {
    const Dense<double> u = dense_u(level, threshold);
    const Energies e = evaluate_energy(level, {.threshold = threshold, .certify = false}, one_thread);
    const double variation = total_variation(u, norm, level.box), data = inner_product(f, u);
    EXPECT_NEAR(e.total_variation, variation, 1e-11 * variation);
    EXPECT_NEAR(e.data, data, 1e-9 * std::abs(data) + 1e-9);
    EXPECT_DOUBLE_EQ(e.primal, level.lambda * e.total_variation - e.data);
    const double dual = dual_energy(dense_p(level), f, [&](Vec3i v) { return level.box.is_free(v); });
    EXPECT_NEAR(e.dual, dual, 1e-12 * std::abs(dual));
  }
}

/// D(p) <= E(u) for every feasible p and every u in [0, 1].
TEST_P(EnergyOfRandomLevels, DualNeverExceedsPrimal) {
  for (const double lambda : {1e-3, 0.1, 10.0}) {
    const RandomLevel random(seed, {.lambda = lambda, .rim = RimFlux::zero, .norm = norm, .open = open});
    for (const std::optional<float> threshold : {std::optional<float>(), std::optional(0.5f)}) {
      const Energies e = evaluate_energy(random.level, {.threshold = threshold, .certify = true}, one_thread);
      EXPECT_LE(e.dual, e.primal);
    }
  }
}

TEST_P(EnergyOfRandomLevels, GapIsTheSumOfLocalTermsThatAreNeverNegative) {
  for (const RimFlux rim : {RimFlux::zero, RimFlux::random}) {
    const RandomLevel random(seed, {.rim = rim, .norm = norm, .open = open});
    const Level& level = random.level;
    const Energies e = evaluate_energy(level, {}, one_thread);
    EXPECT_NEAR(e.gap, e.primal - e.dual, 1e-9 * (std::abs(e.primal) + std::abs(e.dual)));
    EXPECT_DOUBLE_EQ(e.gap, e.gap_band) << "the outside adds nothing here";
    if (rim == RimFlux::random) continue;  // beyond the band boundary its flux is not continued
    const Dense<double> u = dense_u(level), f = dense_f(level);
    const DenseVectors p = dense_p(level);
    const Field<float> shown = local_gap(level, {}, e.max_dual_norm, one_thread);
    double sum = 0, least = 0;
    u.for_each([&](Vec3i v) {
      const double local = gap_at(v, level, u, f, p);
      least = std::min(least, local);
      sum += local;
      expect_shown(shown, v, level, local);
    });
    EXPECT_GE(least, -1e-7 * level.lambda) << "p is feasible but for its rounding to float";
    EXPECT_NEAR(e.gap, sum, 1e-9 * sum);
  }
}

TEST_P(EnergyOfRandomLevels, NoDualGivesTheSumOfTheNegativeData) {
  RandomLevel random(seed, {.rim = RimFlux::zero, .norm = norm, .open = open});
  Level& level = random.level;
  double expected = 0;
  for (size_t b = 0; b < level.grid.size(); ++b) {
    std::fill_n(level.p.brick(b), 3 * brick_volume, 0.0f);
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      if (level.box.is_free(v)) expected += std::min(0.0, -double{level.data(b)[i]});
    });
  }
  EXPECT_NEAR(evaluate_energy(level, {}, one_thread).dual, expected, 1e-12 * std::abs(expected));
}

/// A dual outside the ball is rescaled before it is used as a bound.
TEST_P(EnergyOfRandomLevels, CertifyRescalesAnInfeasibleDual) {
  RandomLevel random(seed, {.rim = RimFlux::zero, .norm = norm, .open = open});
  Level& level = random.level;
  for (size_t b = 0; b < level.grid.size(); ++b)
    for (int i = 0; i < 3 * brick_volume; ++i) level.p.brick(b)[i] *= 3;
  DenseVectors p = dense_p(level);
  double longest = 0;
  p[0].for_each([&](Vec3i v) { longest = std::max(longest, dual_length(vector_at(p, v), norm)); });
  const double factor = longest / level.lambda;
  ASSERT_GT(factor, 2.5);
  for (Dense<double>& component : p) component.for_each([&](Vec3i v) { component[v] /= factor; });

  const Energies e = evaluate_energy(level, {.threshold = {}, .certify = true}, one_thread);
  const double dual = dual_energy(p, dense_f(level), [&](Vec3i v) { return level.box.is_free(v); });
  EXPECT_NEAR(e.max_dual_norm, factor, 1e-9);
  const Field<float> shown = local_gap(level, {.threshold = {}, .certify = true}, e.max_dual_norm, one_thread);
  const Dense<double> u = dense_u(level), f = dense_f(level);
  u.for_each([&](Vec3i v) { expect_shown(shown, v, level, gap_at(v, level, u, f, p)); });
  EXPECT_NEAR(e.dual, dual, 1e-9 * std::abs(dual));
  EXPECT_LE(e.dual, e.primal);
}

/// Where inactive bricks of different labels touch, TV is bounded from above, so that E is never underestimated.
TEST_P(EnergyOfRandomLevels, NeverUnderstatesTheVariationOutsideTheBand) {
  RandomLevel random(seed, {.norm = norm, .open = open});
  fill_some_inactive_bricks(random, seed);
  const double variation = total_variation(dense_u(random.level), norm, random.level.box);
  const Energies e = evaluate_energy(random.level, {}, one_thread);
  EXPECT_GE(e.total_variation, variation * (1 - 1e-12));
  EXPECT_LE(e.total_variation, variation * 2);
}

TEST_P(EnergyOfRandomLevels, DoesNotDependOnThreads) {
  const RandomLevel random(seed, {.norm = norm, .open = open});
  const Energies one = evaluate_energy(random.level, {}, one_thread);
  for (const int threads : {2, 3, 8}) {
    const Energies many = evaluate_energy(random.level, {}, Context(threads));
    EXPECT_EQ(one.primal, many.primal);
    EXPECT_EQ(one.dual, many.dual);
    EXPECT_EQ(one.gap, many.gap);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, EnergyOfRandomLevels,
                         testing::Combine(testing::Values(1, 2, 3, 4),
                                          testing::Values(Norm::isotropic, Norm::anisotropic), testing::Bool()),
                         [](const auto& c) {
                           return (std::get<1>(c.param) == Norm::isotropic ? "isotropic" : "anisotropic") +
                                  std::to_string(std::get<0>(c.param)) + (std::get<2>(c.param) ? "_open" : "");
                         });

/// The null space of the gradient: a block of ones has variation only at its faces, whether the band covers its inside
/// or not.
TEST(Energy, ConstantHasVariationAtItsBorderOnly) {
  Lattice lattice;
  lattice.size = {64, 56, 60};
  const LevelBox box = lattice.box(0);
  const Vec3i n = box.bricks;
  const auto depth = [&](Vec3i b) { return std::min({b.x, b.y, b.z, n.x - 1 - b.x, n.y - 1 - b.y, n.z - 1 - b.z}); };
  const BrickMask all = BrickMask::whole(n);
  BrickMask shell(n);
  all.for_each([&](Vec3i b) { shell.set(b, depth(b) <= 1); });
  for (const BrickMask& band : {all, shell}) {
    const BrickGrid no_support(BrickMask(n), one_thread);
    const Field<float> no_data;
    Level level = make_level(box, 0.1f, band, no_support, no_data, one_thread);
    all.for_each([&](Vec3i b) {
      if (const int32_t active = level.grid.find(b); active >= 0)
        std::fill_n(level.u.brick(static_cast<size_t>(active)), brick_volume, depth(b) > 0 ? 1.0f : 0.0f);
      else
        level.inside.set(level.grid.gap(b), true);
    });
    ASSERT_EQ(level.grid.size() < all.count(), band.count() < all.count());
    const Vec3i block = (n - Vec3i{2, 2, 2}) * brick_side;
    const double faces = 2.0 * (block.x * block.y + block.y * block.z + block.z * block.x);
    const Energies e = evaluate_energy(level, {}, one_thread);
    // At the block's upper edges two or three faces share a vertex, whose gradient is shorter than their sum.
    const double edges = (2 - std::sqrt(2.0)) * (block.x + block.y + block.z - 3) + 3 - std::sqrt(3.0);
    EXPECT_NEAR(e.total_variation, faces - edges, 1e-6);
  }
}

TEST(Energy, IsRelativeToTheDualOrToAThousandFaces) {
  Energies e;
  e.gap = 2;
  e.gap_band = 1;
  e.dual = -100;
  EXPECT_DOUBLE_EQ(e.relative_gap(0.01), 0.02);
  EXPECT_DOUBLE_EQ(e.relative_gap_band(0.01), 0.01);
  EXPECT_DOUBLE_EQ(e.relative_gap(1.0), 0.002);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
