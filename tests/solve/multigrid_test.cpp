// The preconditioner is a symmetric positive definite map, and converges equally fast on boxes of any size.
#include "soapfilm/solve/multigrid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

const Context one_thread(1);

template <class Visit>
void for_each_free(Vec3i free, Visit&& visit) {
  for (int z = 1; z <= free.z; ++z)
    for (int y = 1; y <= free.y; ++y)
      for (int x = 1; x <= free.x; ++x) visit(Vec3i{x, y, z});
}

DenseField<float> random_field(Vec3i free, uint64_t seed) {
  DenseField<float> field = box_field(free);
  Random random(seed);
  for_each_free(free, [&](Vec3i v) { field.at(v) = static_cast<float>(random.normal()); });
  return field;
}

double dot(const DenseField<float>& a, const DenseField<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.count(); ++i) sum += static_cast<double>(a.data()[i]) * b.data()[i];
  return sum;
}

DenseField<float> apply(const BoxLaplacian& matrix, const DenseField<float>& u) {
  const Vec3i free = matrix.free();
  DenseField<float> out = box_field(free);
  for (int z = 1; z <= free.z; ++z)
    for (int y = 1; y <= free.y; ++y) apply_row(matrix.row(y, z), rows_around(u, y, z), free.x, out.row(y, z));
  return out;
}

TEST(BoxLaplacian, IsTheSevenPointStencilWhenAllIntervalsAreAlike) {
  const Vec3i free{6, 1, 4};
  const BoxLaplacian matrix({BoxAxis{free.x}, BoxAxis{free.y}, BoxAxis{free.z}}, 1);
  const DenseField<float> u = random_field(free, 1);
  const DenseField<float> out = apply(matrix, u);
  for_each_free(free, [&](Vec3i v) {
    double expected = 6.0 * u.at(v);
    for (const Vec3i d : {Vec3i{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) expected -= double(u.at(v + d)) + u.at(v - d);
    EXPECT_NEAR(out.at(v), expected, 1e-5);
  });
}

TEST(BoxLaplacian, IsSymmetricAndFlatFunctionsOnlyLeakThroughTheBorder) {
  const Vec3i free{7, 5, 6};
  const BoxLaplacian matrix({BoxAxis{7, 0.5}, BoxAxis{5, 1.25}, BoxAxis{6, 1}}, 2);
  const DenseField<float> a = random_field(free, 1), b = random_field(free, 2);
  EXPECT_NEAR(dot(a, apply(matrix, b)), dot(apply(matrix, a), b), 1e-4);
  EXPECT_GT(dot(a, apply(matrix, a)), 0);

  // For a function that is 1 at all free vertices only the border's faces (area / distance) remain.
  DenseField<float> one = box_field(free);
  for_each_free(free, [&](Vec3i v) { one.at(v) = 1; });
  const double x = 6 + 0.75, y = 4 + 1.125, z = 6;  // the cells' lengths
  EXPECT_NEAR(dot(one, apply(matrix, one)), 2 * (y * z * (1 + 1 / 0.5) + x * z * (1 + 1 / 1.25) + x * y * 2), 1e-3);
}

TEST(AxisTransfer, KeepsTheBorderInPlaceAndInterpolatesLinearly) {
  for (int free = 3; free <= 70; ++free) {
    BoxAxis axis{free};
    while (axis.free >= 3) {
      const AxisTransfer transfer(axis);
      const BoxAxis coarse = transfer.coarse;
      EXPECT_DOUBLE_EQ(2 * (coarse.free + coarse.last), axis.free + axis.last);
      EXPECT_GE(coarse.free, 1);
      EXPECT_GE(coarse.last, 0.5);
      EXPECT_LT(coarse.last, 1.5);
      // The tent that is 0 at both ends and linear beyond the last coarse vertex.
      const double length = axis.free + axis.last, top = 2 * coarse.free;
      for (int i = 1; i <= axis.free; ++i) {
        double sum = 0;
        for (const AxisTransfer::Share& share : transfer.at(i)) {
          if (share.weight != 0) {
            EXPECT_TRUE(share.coarse >= 1 && share.coarse <= coarse.free);
          }
          sum += 2.0 * share.coarse * share.weight;
        }
        const double expected = i <= top ? i : top * (length - i) / (length - top);
        EXPECT_NEAR(sum, expected, 1e-4) << free << " " << i;
      }
      axis = coarse;
    }
  }
}

class OnBoxes : public testing::TestWithParam<Vec3i> {};

TEST_P(OnBoxes, TheCycleIsSymmetricAndPositiveDefinite) {
  const Vec3i free = GetParam();
  Multigrid multigrid(free);
  const DenseField<float> a = random_field(free, 1), b = random_field(free, 2);
  DenseField<float> to_a = box_field(free), to_b = box_field(free);
  multigrid.precondition(a, to_a, one_thread);
  multigrid.precondition(b, to_b, one_thread);
  const double scale = std::sqrt(dot(a, to_a) * dot(b, to_b));
  EXPECT_GT(dot(a, to_a), 0);
  EXPECT_GT(dot(b, to_b), 0);
  EXPECT_NEAR(dot(a, to_b), dot(to_a, b), 1e-5 * scale);
}

/// The reduction of the energy norm by one step u -= B A u, measured on the rest of a random u after seven of them.
TEST_P(OnBoxes, TheCycleReducesTheErrorAlike) {
  const Vec3i free = GetParam();
  Multigrid multigrid(free);
  DenseField<float> u = random_field(free, 3), correction = box_field(free);
  double first = 0, previous = 0, rate = 0;
  for (int step = 0; step <= 8; ++step) {
    const DenseField<float> residual = apply(multigrid.matrix(), u);
    const double energy = dot(u, residual);
    if (step == 0) first = energy;
    rate = previous > 1e-12 * first ? std::sqrt(energy / previous) : 0;  // at rounding there is nothing to reduce
    previous = energy;
    multigrid.precondition(residual, correction, one_thread);
    for (size_t i = 0; i < u.count(); ++i) u.data()[i] -= correction.data()[i];
  }
  EXPECT_LT(rate, 0.42);
}

INSTANTIATE_TEST_SUITE_P(Sizes, OnBoxes,
                         testing::Values(Vec3i{1, 1, 1}, Vec3i{2, 1, 3}, Vec3i{3, 3, 3}, Vec3i{4, 5, 6},
                                         Vec3i{31, 31, 31}, Vec3i{32, 32, 32}, Vec3i{33, 34, 35}, Vec3i{63, 40, 21},
                                         Vec3i{62, 61, 60}, Vec3i{150, 9, 2}, Vec3i{4, 200, 17}, Vec3i{100, 100, 100}),
                         [](const auto& box) {
                           return std::to_string(box.param.x) + "x" + std::to_string(box.param.y) + "x" +
                                  std::to_string(box.param.z);
                         });

}  // namespace TEST_FILE
}  // namespace soapfilm
