#include "soapfilm/field/sampling.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "soapfilm/pyramid/critical_lambda.h"
#include "support/problem.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

TEST(Sampling, MeasuresTheDensityOfEvenSamples) {
  for (const std::string& name : shape_names()) {
    const auto shape = make_shape(name);
    const double area = area_of(*shape);
    for (const size_t count : {4000, sanitized ? 12000 : 40000}) {
      const double per_area = static_cast<double>(count) / area;
      const Sampling sampling = measure_sampling(sample_surface(*shape, count, 1), Context());
      EXPECT_GT(sampling.per_area, 0.8 * per_area) << name << ", " << count;
      EXPECT_LT(sampling.per_area, 1.4 * per_area) << name << ", " << count;
    }
  }
}

/// What is sampled is a thousandth of the box: far finer cells than there would be for an object that fills it.
TEST(Sampling, FindsTheScaleOfASmallPatch) {
  PointCloud cloud;
  Random random(3);
  const Vec3d a = normalized(Vec3d{1, 0.3, -0.2}), b = normalized(cross(a, Vec3d{0.1, 1, 0.4}));
  for (int i = 0; i < 4000; ++i) cloud.positions.push_back(random.uniform() * a + random.uniform() * b);
  const double alone = measure_sampling(cloud, Context()).per_area;
  EXPECT_NEAR(alone, 4000, 1000);
  cloud.positions.push_back({1000, 0, 0});
  EXPECT_NEAR(measure_sampling(cloud, Context()).per_area, alone, 0.2 * alone);
}

TEST(Sampling, IsRobustAgainstOutliers) {
  PointCloud cloud = sample_surface(*make_torus(), 20000, 1);
  const double clean = measure_sampling(cloud, Context()).per_area;
  Random random(2);
  for (size_t i = 0; i < cloud.size(); i += 10)
    for (int axis = 0; axis < 2; ++axis) cloud.positions[i][axis] = random.uniform(-0.5, 0.5);
  EXPECT_NEAR(measure_sampling(cloud, Context()).per_area, 0.9 * clean, 0.1 * clean);
}

/// The definition, cell by cell: the finest of 16 depths with four companions on average.
double counted_per_area(const PointCloud& cloud) {
  const Box3d box = cloud.box();
  for (int depth = 16;; --depth) {
    std::map<std::array<int, 3>, double> cells;
    for (const Vec3d& p : cloud.positions) {
      std::array<int, 3> cell{};
      for (int axis = 0; axis < 3; ++axis)
        cell[static_cast<size_t>(axis)] =
            static_cast<int>(std::min((p[axis] - box.lo[axis]) / box.longest() * 65536, 65535.0)) >> (16 - depth);
      ++cells[cell];
    }
    double pairs = 0;
    for (const auto& [cell, n] : cells) pairs += n * (n - 1);
    const double companions = pairs / static_cast<double>(cloud.size()), side = box.longest() / (1 << depth);
    if (companions >= 4 || depth == 1) return companions / (0.9413 * side * side);
  }
}

TEST(Sampling, CountsAsAMapDoesOnAnyNumberOfThreads) {
  PointCloud even = sample_surface(*make_torus(), 30000, 1), clustered = even;
  // More in one cell than a thread counts at once, each at a place of its own.
  for (int i = 1; i <= 70000; ++i) clustered.positions.push_back(even.positions[5] + Vec3d{1e-12 * i, 0, 0});
  for (const PointCloud* cloud : {&even, &clustered}) {
    const double counted = counted_per_area(*cloud);
    for (const int threads : {1, 2, 3, 8})
      EXPECT_EQ(measure_sampling(*cloud, Context(threads)).per_area, counted) << threads << " threads";
  }
}

/// A camera's pixels without depth all lie at its origin; a cloud is given twice over and more. Neither makes the
/// surface denser, at any scale.
TEST(Sampling, CountsEachPlaceOnceWhereSamplesRepeat) {
  const PointCloud surface = sample_surface(*make_torus(), 20000, 1);
  const Sampling clean = measure_sampling(surface, Context(1));
  EXPECT_EQ(clean.repeats, 0u);
  for (const size_t pixels : {1000, 20000, 60000}) {
    PointCloud cloud = surface;
    cloud.positions.insert(cloud.positions.begin() + 7, pixels, Vec3d{});
    const Sampling sampling = measure_sampling(cloud, Context(1));
    EXPECT_NEAR(sampling.per_area, clean.per_area, 0.01 * clean.per_area) << pixels;
    EXPECT_EQ(sampling.repeats, pixels - 1);
    EXPECT_EQ(sampling.most_repeated, Vec3d{});
  }
  PointCloud many = surface;
  for (int copy = 1; copy < 6; ++copy)
    many.positions.insert(many.positions.end(), surface.positions.begin(), surface.positions.end());
  EXPECT_DOUBLE_EQ(measure_sampling(many, Context(1)).per_area, clean.per_area);
}

TEST(Sampling, ScalesWithTheUnits) {
  PointCloud cloud = sample_surface(*make_sphere(), 5000, 1);
  const double meters = measure_sampling(cloud, Context()).per_area;
  for (Vec3d& p : cloud.positions) p = p * 1024.0;
  EXPECT_DOUBLE_EQ(measure_sampling(cloud, Context()).per_area * 1024 * 1024, meters);
}

TEST(Sampling, VoxelAndDensityAreInverse) {
  const Sampling sampling = measure_sampling(sample_surface(*make_sphere(), 5000, 1), Context());
  for (const double density : {0.1, 1.0, 7.0}) EXPECT_NEAR(sampling.density(sampling.voxel(density)), density, 1e-12);
  EXPECT_EQ(Sampling{}.voxel(1), 0);
}

/// The edge is proportional to the density: lambda / density, measured, is the same over two decades.
TEST(CriticalLambda, OfASphereIsAFixedShareOfTheDensitySlow) {
  const Context one_thread(1);
  for (const double density : {0.05, 0.5, 5.0}) {
    const Problem problem = make_problem(sampled("sphere", 56, density), 56);
    const double edge = critical_lambda(problem.lattice, problem.support, density, one_thread);
    EXPECT_NEAR(edge / density, critical_density, 0.05 * critical_density) << density;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
