// A dense u copied to a band keeps its values and its energy.
#include "soapfilm/solve/dense_level.h"

#include <gtest/gtest.h>

#include "soapfilm/solve/energy.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using test::make_problem;
using test::sampled;

TEST(DenseLevel, HoldsTheDenseValuesInAndOutsideTheBand) {
  const test::Problem problem = make_problem(sampled("torus", 64, 1), 64);
  const Context context(2);
  const LevelBox box = problem.lattice.box(0);
  DenseField<float> u(box);
  EXPECT_EQ(u.size(), problem.lattice.size);
  const Vec3i center = (box.free_lo + box.free_hi) / 2;
  const auto inside = [&](Vec3i v) {
    const Vec3i d = v - center;
    return d.x * d.x + d.y * d.y + d.z * d.z < 20 * 20 && box.is_free(v);
  };
  for (int z = 0; z < u.size().z; ++z)
    for (int y = 0; y < u.size().y; ++y)
      for (int x = 0; x < u.size().x; ++x) {
        const Vec3i v = u.origin() + Vec3i{x, y, z};
        u.at(v) = inside(v) ? 1.0f : 0.0f;
      }
  const float lambda = 0.01f;
  const Level level = level_of(u, box, lambda, problem.support.grid, problem.support.f, context);
  EXPECT_LT(level.grid.size(), static_cast<size_t>(box.bricks.x) * box.bricks.y * box.bricks.z);

  size_t count = 0;
  double variation = 0, data = 0;
  const Vec3i end = box.bricks * brick_side;
  for (int z = 0; z < end.z; ++z) {
    for (int y = 0; y < end.y; ++y) {
      for (int x = 0; x < end.x; ++x) {
        const Vec3i v{x, y, z};
        const int32_t slot = level.grid.find(brick_of(v));
        const int at = brick_offset(x & 7, y & 7, z & 7);
        const float value = slot >= 0 ? level.u.brick(slot)[at] : level.missing_u(slot, brick_of(v));
        ASSERT_EQ(value, inside(v) ? 1.0f : 0.0f) << x << " " << y << " " << z;
        count += inside(v);
        double squared = 0;
        for (int k = 0; k < 3; ++k) {
          const double d = double(inside(v + test::along(k))) - double(inside(v));
          squared += d * d;
        }
        variation += std::sqrt(squared);
        if (slot >= 0 && inside(v)) data += level.data(static_cast<size_t>(slot))[at];
      }
    }
  }
  const Energies energies = evaluate_energy(level, {}, context);
  EXPECT_GT(count, 10000u);
  EXPECT_NEAR(energies.total_variation, variation, 1e-9 * variation);
  EXPECT_NEAR(energies.data, data, 1e-6 * variation);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
