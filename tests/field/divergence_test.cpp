#include "soapfilm/field/divergence.h"

#include <gtest/gtest.h>

#include "soapfilm/grid/smoothing.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr int resolution = 28;

/// Section 4.1 to the letter, in double on a dense grid: splat, smooth three times with the box filter along each axis,
/// central differences.
Dense<double> brute_force(const PointCloud& cloud, const Lattice& lattice) {
  const Dense<double> zero(lattice.box(0).bricks * brick_side);
  DenseVectors v{zero, zero, zero};
  for (size_t s = 0; s < cloud.size(); ++s) {
    const Vec3d q = lattice.to_lattice(cloud.positions[s]);
    const Vec3i cell{static_cast<int>(std::floor(q.x)), static_cast<int>(std::floor(q.y)),
                     static_cast<int>(std::floor(q.z))};
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i c{corner & 1, corner >> 1 & 1, corner >> 2};
      double weight = cloud.weights.empty() ? 1.0 : cloud.weights[s];
      for (int axis = 0; axis < 3; ++axis) weight *= 1 - std::abs(q[axis] - cell[axis] - c[axis]);
      for (int axis = 0; axis < 3; ++axis) v[static_cast<size_t>(axis)][cell + c] += weight * cloud.normals[s][axis];
    }
  }
  for (Dense<double>& component : v)
    for (int pass = 0; pass < 9; ++pass) {
      const Vec3i step = along(pass % 3);
      Dense<double> box = zero;
      box.for_each([&](Vec3i x) { box[x] = (component.get(x - step) + component[x] + component.get(x + step)) / 3; });
      component = box;
    }
  Dense<double> f = zero;
  f.for_each([&](Vec3i x) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto& component = v[static_cast<size_t>(axis)];
      f[x] += (component.get(x + along(axis)) - component.get(x - along(axis))) / 2;
    }
  });
  return f;
}

double largest_difference(const Dense<double>& a, const Dense<double>& b) {
  double worst = 0;
  a.for_each([&](Vec3i v) { worst = std::max(worst, std::abs(a[v] - b[v])); });
  return worst;
}

/// Samples in a box; the lattice is placed around [0, 1]^3 whatever they are.
Lattice unit_box_lattice() {
  const Box3d unit{{0, 0, 0}, {1, 1, 1}};
  return place_lattice(unit, voxel_of_resolution(unit, resolution, 6), 6);
}

PointCloud random_cloud(size_t count, uint64_t seed) {
  Random random(seed);
  PointCloud cloud;
  for (size_t i = 0; i < count; ++i) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    const double a = random.normal(), b = random.normal(), c = random.normal();
    cloud.positions.push_back({x, y, z});
    cloud.normals.push_back(Vec3f(normalized(Vec3d{a, b, c})));
  }
  return cloud;
}

Dense<double> field_of(const PointCloud& cloud, int threads = 1) {
  const Problem problem = make_problem(cloud, unit_box_lattice(), threads);
  return dense_field(problem.support, problem.lattice.box(0));
}

TEST(Divergence, OfOneSampleIsWhatSection41Says) {
  const Lattice lattice = unit_box_lattice();
  // Inside a brick, on its faces and corner, on a vertex, and at the samples' box's corners.
  for (const Vec3d p : {Vec3d{0.31, 0.52, 0.74}, lattice.to_world({16, 20.3, 17.1}), lattice.to_world({16, 16, 16}),
                        lattice.to_world({15.999, 15.5, 8.001}), Vec3d{0, 0, 0}, Vec3d{1, 1, 1}}) {
    PointCloud cloud;
    cloud.positions = {p};
    cloud.normals = {{0.6f, -0.48f, 0.64f}};
    EXPECT_LT(largest_difference(field_of(cloud), brute_force(cloud, lattice)), 2e-7);
  }
}

TEST(Divergence, OfManySamplesIsTheSumOverThem) {
  PointCloud cloud = random_cloud(500, 1);
  EXPECT_LT(largest_difference(field_of(cloud), brute_force(cloud, unit_box_lattice())), 2e-6);
  Random random(2);
  for (size_t i = 0; i < cloud.size(); ++i) cloud.weights.push_back(static_cast<float>(random.uniform(0, 3)));
  EXPECT_LT(largest_difference(field_of(cloud), brute_force(cloud, unit_box_lattice())), 5e-6);
}

TEST(Divergence, IsLinearInTheDirections) {
  const PointCloud cloud = random_cloud(500, 3);
  PointCloud doubled = cloud;
  for (Vec3f& n : doubled.normals) n = n * 2.0f;
  const Dense<double> f = field_of(cloud), twice = field_of(doubled);
  f.for_each([&](Vec3i v) { ASSERT_EQ(2 * f[v], twice[v]); });

  PointCloud both = cloud;
  both.append(random_cloud(500, 4));
  const Dense<double> other = field_of(random_cloud(500, 4)), sum = field_of(both);
  double worst = 0;
  f.for_each([&](Vec3i v) { worst = std::max(worst, std::abs(f[v] + other[v] - sum[v])); });
  EXPECT_LT(worst, 2e-6);
}

TEST(Divergence, SumsToZero) {
  const Dense<double> f = field_of(random_cloud(3000, 5));
  double sum = 0, magnitude = 0;
  for (const double value : f.values()) {
    sum += value;
    magnitude += std::abs(value);
  }
  EXPECT_LT(std::abs(sum), 1e-7 * magnitude);
}

TEST(Divergence, IsPositiveJustInsideAndNegativeJustOutside) {
  const auto sphere = make_sphere();
  const Problem problem = make_problem(sampled(*sphere, 40, 4), 40);
  const Dense<double> f = dense_field(problem.support, problem.lattice.box(0));
  int wrong = 0, checked = 0;
  f.for_each([&](Vec3i v) {
    const double distance = sphere->signed_distance(problem.lattice.to_world(Vec3d(v))) / problem.lattice.voxel;
    if (std::abs(distance) < 1 || std::abs(distance) > 2) return;
    ++checked;
    wrong += (f[v] > 0) != (distance < 0);
  });
  EXPECT_GT(checked, 1000);
  EXPECT_LT(wrong, 0.01 * checked);
}

TEST(Divergence, SupportHoldsEveryVertexThatASampleReaches) {
  const PointCloud cloud = random_cloud(20, 6);
  const Problem problem = make_problem(cloud, unit_box_lattice());
  const BrickMask support = support_mask(problem.samples, problem.lattice.box(0), Context(1));
  EXPECT_EQ(support.count(), problem.support.grid.size());
  const Dense<double> f = brute_force(cloud, problem.lattice);
  size_t missed = 0, reached = 0;
  f.for_each([&](Vec3i v) {
    if (f[v] == 0) return;
    ++reached;
    missed += !support.test(brick_of(v));
  });
  EXPECT_GT(reached, 3000u);
  EXPECT_EQ(missed, 0u);
}

TEST(Divergence, DoesNotDependOnThreads) {
  const PointCloud cloud = random_cloud(5000, 7);
  const Dense<double> one = field_of(cloud, 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(field_of(cloud, threads).values(), one.values());
}

TEST(Smoothing, TapsAreThreeBoxesAndSumToOne) {
  double sum = 0;
  for (const float tap : smoothing_taps) sum += tap;
  EXPECT_NEAR(sum, 1, 1e-7);
  std::vector<double> taps{1};
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> wider(taps.size() + 2, 0.0);
    for (size_t i = 0; i < taps.size(); ++i)
      for (size_t j = 0; j < 3; ++j) wider[i + j] += taps[i] / 3;
    taps = wider;
  }
  ASSERT_EQ(taps.size(), smoothing_taps.size());
  for (size_t i = 0; i < taps.size(); ++i) EXPECT_NEAR(taps[i], smoothing_taps[i], 1e-7);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
