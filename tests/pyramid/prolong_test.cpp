#include "soapfilm/pyramid/prolong.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/pyramid/restrict.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// Two levels, all bricks active, without data.
struct TwoLevels {
  Lattice lattice;
  SupportField no_data;
  Level coarse;

  static Lattice small() {
    Lattice lattice;
    lattice.size = {50, 37, 44};
    lattice.levels = 2;
    return lattice;
  }

  explicit TwoLevels(const Lattice& on = small()) : lattice(on) {
    no_data.grid = BrickGrid(BrickMask(lattice.box(0).bricks), one_thread);
    coarse = make_level(lattice.box(1), 0.4f, BrickMask::whole(lattice.box(1).bricks),
                        BrickGrid(BrickMask(lattice.box(1).bricks), one_thread), no_data.f, one_thread);
  }

  Level fine(const BrickMask& band) const { return prolong_level(coarse, lattice.box(0), band, no_data, one_thread); }
  Level fine() const { return fine(BrickMask::whole(lattice.box(0).bricks)); }

  void fill_coarse(const auto& u, uint64_t seed) {
    Random random(seed);
    for (size_t b = 0; b < coarse.grid.size(); ++b)
      for_each_vertex(coarse.grid.coord(b), [&](Vec3i v, int i) {
        coarse.u.brick(b)[i] = coarse.box.is_free(v) ? static_cast<float>(u(Vec3d(v))) : 0.0f;
        for (int axis = 0; axis < 3; ++axis) coarse.p.brick(b, axis)[i] = static_cast<float>(random.uniform(-0.2, 0.2));
      });
  }
};

/// Coarse vertex I is the center of fine vertices 2I and 2I + 1.
Vec3d coarse_position(Vec3i fine) { return (Vec3d(fine) - Vec3d{0.5, 0.5, 0.5}) / 2.0; }

TEST(Prolong, ReproducesLinearFunctionsInside) {
  const auto linear = [](Vec3d v) { return 0.1 + 0.010 * v.x + 0.007 * v.y + 0.004 * v.z; };
  TwoLevels levels;
  levels.fill_coarse(linear, 1);
  const Level fine = levels.fine();
  const LevelBox& box = levels.coarse.box;
  size_t interior = 0;
  dense_u(fine).for_each([&](Vec3i v) {
    // All eight coarse vertices around it are free.
    const Vec3i nearest{v.x >> 1, v.y >> 1, v.z >> 1};
    if (!box.is_free(nearest - Vec3i{1, 1, 1}) || !box.is_free(nearest + Vec3i{1, 1, 1})) return;
    ++interior;
    const int32_t b = fine.grid.find(brick_of(v));
    ASSERT_NEAR(fine.u.brick(static_cast<size_t>(b))[brick_offset(v.x & 7, v.y & 7, v.z & 7)],
                linear(coarse_position(v)), 1e-6);
  });
  EXPECT_GT(interior, 40000u);
}

TEST(Prolong, KeepsFixedVerticesAtZero) {
  TwoLevels levels;
  levels.fill_coarse([](Vec3d) { return 1.0; }, 2);
  const Level fine = levels.fine();
  const Dense<double> u = dense_u(fine);
  u.for_each([&](Vec3i v) { ASSERT_TRUE(u[v] == 0 || fine.box.is_free(v)); });
}

TEST(Prolong, SharesTheDivergenceEquallyAmongTheChildren) {
  TwoLevels levels;
  levels.fill_coarse([](Vec3d) { return 0.5; }, 3);
  const Level fine = levels.fine();
  const DenseVectors coarse_p = dense_p(levels.coarse), fine_p = dense_p(fine);
  double worst = 0;
  fine_p[0].for_each([&](Vec3i v) {
    const double parent = adjoint_at(coarse_p, {v.x >> 1, v.y >> 1, v.z >> 1});
    worst = std::max(worst, std::abs(adjoint_at(fine_p, v) - parent / 8));
  });
  EXPECT_LT(worst, 1e-7);
  EXPECT_EQ(fine.lambda, levels.coarse.lambda / 4);
}

/// A smaller band sees through its rim the flux that the whole prolonged dual has there.
TEST(Prolong, RimCarriesTheFluxOfTheWholeProlongation) {
  TwoLevels levels;
  levels.fill_coarse([](Vec3d v) { return v.x < 12 ? 1.0 : 0.0; }, 4);
  const DenseVectors whole = dense_p(levels.fine());
  Random random(5);
  BrickMask band(levels.lattice.box(0).bricks);
  const BrickMask all = BrickMask::whole(band.bricks());
  // The surface is in the band, as always: a gap has one side.
  const LevelBox box = levels.lattice.box(0);
  all.for_each(
      [&](Vec3i b) { band.set(b, b.x == 2 || b.x == 3 || !free_range(box, b).whole() || random.uniform() < 0.5); });
  const Level fine = levels.fine(band);
  size_t faces = 0;
  for (size_t b = 0; b < fine.grid.size(); ++b)
    for (int axis = 0; axis < 3; ++axis)
      for_each_low_rim_face(fine, b, axis, [&](Vec3i v, float flux) {
        ++faces;
        ASSERT_EQ(flux, static_cast<float>(whole[static_cast<size_t>(axis)][v]));
      });
  EXPECT_GT(faces, 1000u);
  all.for_each([&](Vec3i b) {
    if (band.test(b) || !fine.box.is_free(b * brick_side)) return;
    EXPECT_EQ(fine.inside.test(fine.grid, b), b.x < 3);
  });
}

/// Growing the band keeps what was already solved.
TEST(Prolong, BricksOfThePreviousBandKeepTheirState) {
  TwoLevels levels;
  levels.fill_coarse([](Vec3d) { return 0.25; }, 6);
  BrickMask band(levels.lattice.box(0).bricks);
  band.set({2, 2, 2});
  band.set({3, 2, 2});
  Level previous = levels.fine(band);
  for (size_t b = 0; b < previous.grid.size(); ++b) {
    std::fill_n(previous.u.brick(b), brick_volume, 0.875f);
    std::fill_n(previous.p.brick(b), 3 * brick_volume, 0.0625f);
  }
  band.set({2, 3, 2});
  const Level grown =
      prolong_level(levels.coarse, levels.lattice.box(0), band, levels.no_data, one_thread, std::move(previous));
  const Level fresh = levels.fine(band);
  for (size_t b = 0; b < grown.grid.size(); ++b) {
    const bool is_new = grown.grid.coord(b).y == 3;
    EXPECT_EQ(grown.u.brick(b)[100], is_new ? fresh.u.brick(b)[100] : 0.875f);
    EXPECT_EQ(grown.p.brick(b)[700], is_new ? fresh.p.brick(b)[700] : 0.0625f);
  }
}

/// Memory that goes back on the way was not needed any more.
TEST(Prolong, OfALevelThatIsGivenUpIsTheSame) {
  Lattice lattice = TwoLevels::small();
  lattice.size = {170, 100, 180};  // layers of many pages
  const auto wave = [](Vec3d v) { return 0.5 + 0.4 * std::sin(0.3 * v.x + 0.2 * v.y + 0.5 * v.z); };
  TwoLevels large(lattice);
  large.fill_coarse(wave, 7);
  Random random(8);
  BrickMask band(lattice.box(0).bricks);
  const BrickMask all = BrickMask::whole(band.bricks());
  all.for_each([&](Vec3i b) { band.set(b, random.uniform() < 0.7); });
  const Level kept = large.fine(band);
  for (const int threads : {1, 3}) {
    TwoLevels given_up(lattice);
    given_up.fill_coarse(wave, 7);
    const Level fine = prolong_level(std::move(given_up.coarse), lattice.box(0), band, large.no_data, Context(threads));
    EXPECT_EQ(fine.outside.dual, kept.outside.dual);
    ASSERT_TRUE(std::equal(fine.u.brick(0), fine.u.brick(0) + fine.grid.vertices(), kept.u.brick(0)));
    ASSERT_TRUE(std::equal(fine.p.brick(0), fine.p.brick(0) + 3 * fine.grid.vertices(), kept.p.brick(0)));
    for (size_t gap = 0; gap < fine.grid.gaps(); ++gap) ASSERT_EQ(fine.inside[gap], kept.inside[gap]);
  }
}

TEST(Restrict, SumsTheEightChildren) {
  const Problem problem = make_problem(sampled("torus", 40, 1), 40);
  const LevelBox fine_box = problem.lattice.box(0), coarse_box = problem.lattice.box(1);
  const SupportField coarse = restrict_field(problem.support, coarse_box, one_thread);
  const Dense<double> fine_f = dense_field(problem.support, fine_box), coarse_f = dense_field(coarse, coarse_box);
  Dense<double> sums(coarse_f.size());
  fine_f.for_each([&](Vec3i v) { sums[{v.x >> 1, v.y >> 1, v.z >> 1}] += fine_f[v]; });
  double worst = 0, largest = 0;
  sums.for_each([&](Vec3i v) {
    worst = std::max(worst, std::abs(sums[v] - coarse_f[v]));
    largest = std::max(largest, std::abs(sums[v]));
  });
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(worst, 1e-6 * largest);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
