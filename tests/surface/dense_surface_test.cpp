#include "soapfilm/surface/dense_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "soapfilm/error.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// 30 exp(-(r / 15)^2) around the center of the box, 0 at fixed vertices: unbounded above, as Poisson's u is.
DenseField<float> bell(const LevelBox& box) {
  DenseField<float> u(box);
  const Vec3d center = Vec3d(box.free_lo + box.free_hi) * 0.5;
  for (int z = box.free_lo.z; z <= box.free_hi.z; ++z)
    for (int y = box.free_lo.y; y <= box.free_hi.y; ++y)
      for (int x = box.free_lo.x; x <= box.free_hi.x; ++x) {
        const double r = norm(Vec3d(Vec3i{x, y, z}) - center) / 15;
        u.at({x, y, z}) = static_cast<float>(30 * std::exp(-r * r));
      }
  return u;
}

class DenseSurfaceTest : public testing::Test {
 protected:
  Problem problem = make_problem(sampled("torus", 70, 1), 70);
  LevelBox box = problem.lattice.box(0);
  DenseField<float> u = bell(box);
};

TEST_F(DenseSurfaceTest, BothFormsAreTheSolidAboveTheIsovalueAtEveryVertex) {
  for (const double isovalue : {0.5, 12.0, 29.0, 40.0}) {
    const DenseSurface surface = dense_surface(u, isovalue, box, one_thread);
    const BrickGrid& grid = surface.field.grid;
    Dense<double>(box.bricks * brick_side).for_each([&](Vec3i v) {
      const bool inside = u.get(v) > isovalue;
      ASSERT_EQ(surface.binary.get(v), inside ? 1.0f : 0.0f);
      const int32_t b = grid.find(brick_of(v));
      const float value = b >= 0 ? surface.field.value.brick(b)[brick_offset(v.x & 7, v.y & 7, v.z & 7)]
                                 : surface.field.missing_value(brick_of(v));
      ASSERT_EQ(value > 0.5f, inside);
      if (b >= 0) {
        ASSERT_NEAR(value, u.get(v) / (2 * isovalue), 1e-5 * value);
      }
    });
    EXPECT_LT(grid.size(), static_cast<size_t>(box.bricks.x) * box.bricks.y * box.bricks.z);
    EXPECT_EQ(grid.size() == 0, isovalue > 30);
  }
}

TEST_F(DenseSurfaceTest, MeanAtTheSamplesIsTheMeanOfTheTrilinearInterpolation) {
  double sum = 0;
  for (size_t b = 0; b < problem.samples.bricks.size(); ++b)
    for (uint32_t s = problem.samples.begin[b]; s < problem.samples.begin[b + 1]; ++s) {
      const Vec3d q = Vec3d(problem.samples.bricks.first_vertex(b)) + Vec3d(problem.samples.local[s]);
      const Vec3i cell(q);
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3i v = cell + Vec3i{corner & 1, corner >> 1 & 1, corner >> 2};
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) weight *= 1 - std::abs(q[axis] - v[axis]);
        sum += weight * u.get(v);
      }
    }
  const double mean = mean_at_samples(u, problem.samples, one_thread);
  EXPECT_NEAR(mean, sum / static_cast<double>(problem.samples.size()), 1e-9 * mean);
  EXPECT_EQ(mean, mean_at_samples(u, problem.samples, Context(3)));
}

TEST_F(DenseSurfaceTest, RefusesAnIsovalueThatTheOutsideOfTheBoxExceeds) {
  for (const double isovalue : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(dense_surface(u, isovalue, box, one_thread), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
