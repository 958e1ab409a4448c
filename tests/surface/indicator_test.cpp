#include "soapfilm/surface/indicator.h"

#include <gtest/gtest.h>

#include "soapfilm/grid/smoothing.h"
#include "support/dense.h"
#include "support/problem.h"
#include "support/random_level.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// The binary indicator smoothed three times with the box filter along each axis, in double; 0 beyond the box.
Dense<double> brute_force(const Level& level, float threshold) {
  Dense<double> value = dense_u(level, threshold);
  for (int pass = 0; pass < 9; ++pass) {
    const Vec3i step = along(pass % 3);
    Dense<double> box(value.size());
    box.for_each([&](Vec3i v) { box[v] = (value.get(v - step) + value[v] + value.get(v + step)) / 3; });
    value = box;
  }
  return value;
}

class Indicator : public testing::TestWithParam<std::string> {
 protected:
  Problem problem = make_problem(sampled(GetParam(), 60, 1), 60);
  PyramidSolution solution = solve(problem, 0.02, 1e-3);

  Labels labels(float threshold) const { return labels_of(solution.finest, threshold, one_thread); }
};

TEST_P(Indicator, IsTheSmoothedThresholdedField) {
  for (const float threshold : {0.5f, 0.2f}) {
    const IndicatorField field = smoothed_indicator(labels(threshold), one_thread);
    const Dense<double> expected = brute_force(solution.finest, threshold);
    size_t in_grid = 0;
    double worst = 0;
    expected.for_each([&](Vec3i v) {
      const int32_t b = field.grid.find(brick_of(v));
      in_grid += b >= 0;
      const double value = b >= 0 ? field.value.brick(static_cast<size_t>(b))[brick_offset(v.x & 7, v.y & 7, v.z & 7)]
                                  : field.missing_value(brick_of(v));
      worst = std::max(worst, std::abs(value - expected[v]));
    });
    EXPECT_LT(worst, 1e-6);
    EXPECT_LT(in_grid, expected.values().size()) << "only the bricks near the surface";
  }
}

TEST_P(Indicator, WithoutSmoothingIsTheThresholdedFieldItself) {
  for (const float threshold : {0.5f, 0.2f}) {
    const IndicatorField field = binary_indicator(labels(threshold), one_thread);
    const Dense<double> expected = dense_u(solution.finest, threshold);
    size_t wrong = 0;
    expected.for_each([&](Vec3i v) {
      const int32_t b = field.grid.find(brick_of(v));
      const double value = b >= 0 ? field.value.brick(static_cast<size_t>(b))[brick_offset(v.x & 7, v.y & 7, v.z & 7)]
                                  : field.missing_value(brick_of(v));
      wrong += value != expected[v];
    });
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(field.grid.size(), smoothed_indicator(labels(threshold), one_thread).grid.size());
  }
}

TEST_P(Indicator, MeanAtTheSamplesIsTheMeanOfTheTrilinearInterpolation) {
  const IndicatorField field = smoothed_indicator(labels(0.5f), one_thread);
  const Dense<double> value = brute_force(solution.finest, 0.5f);
  double sum = 0;
  for (size_t b = 0; b < problem.samples.bricks.size(); ++b)
    for (uint32_t s = problem.samples.begin[b]; s < problem.samples.begin[b + 1]; ++s) {
      const Vec3d q = Vec3d(problem.samples.bricks.first_vertex(b)) + Vec3d(problem.samples.local[s]);
      const Vec3i cell{static_cast<int>(q.x), static_cast<int>(q.y), static_cast<int>(q.z)};
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3i v = cell + Vec3i{corner & 1, corner >> 1 & 1, corner >> 2};
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) weight *= 1 - std::abs(q[axis] - v[axis]);
        sum += weight * value[v];
      }
    }
  const double mean = sum / static_cast<double>(problem.samples.size());
  EXPECT_NEAR(mean_at_samples(field, problem.samples, one_thread), mean, 1e-6);
  EXPECT_EQ(mean_at_samples(field, problem.samples, Context(3)), mean_at_samples(field, problem.samples, one_thread));
  EXPECT_NEAR(mean, 0.5, 0.15) << "the samples lie on the surface";
}

INSTANTIATE_TEST_SUITE_P(Shapes, Indicator, testing::Values("sphere", "part", "knot"),
                         [](const auto& s) { return s.param; });

}  // namespace TEST_FILE
}  // namespace soapfilm
