#include "soapfilm/orient/local_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/core/random.h"
#include "soapfilm/orient/area_weights.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

const Context one_thread(1);

LocalSurface around(const PointCloud& cloud, const Context& context = one_thread) {
  return measure_local_surface(cloud.positions, cloud.normals, cloud.box(), context);
}

PointCloud sphere(size_t samples) { return sample_surface(*make_sphere(), samples, 1); }

/// Samples of the square [0, 1]^2 in the plane z, normals up or down.
void add_square(PointCloud& cloud, size_t samples, double z, float up, uint64_t seed) {
  Random random(seed);
  for (size_t i = 0; i < samples; ++i) {
    cloud.positions.push_back({random.uniform(), random.uniform(), z});
    cloud.normals.push_back({0, 0, up});
  }
}

TEST(LocalSurface, KnowsASphere) {
  const PointCloud cloud = sphere(20000);
  const LocalSurface surface = around(cloud);
  const double area = *make_sphere()->area();
  EXPECT_GT(static_cast<double>(surface.planes), 0.98 * static_cast<double>(cloud.size()));
  EXPECT_NEAR(surface.coverage.area, area, 0.1 * area);
  EXPECT_NEAR(surface.coverage.spacing, std::sqrt(area / 20000), 0.15 * std::sqrt(area / 20000));
  double cosine = 0;
  for (size_t i = 0; i < cloud.size(); ++i) cosine += std::abs(dot(surface.normal[i], normalized(cloud.normals[i])));
  EXPECT_GT(cosine / static_cast<double>(surface.planes), 0.99);
}

/// A unit square in rows: `columns` x `rows` samples, nearly in line, the square turned about y.
PointCloud raster(int columns, int rows, double angle) {
  PointCloud cloud;
  Random random(1);
  const double c = std::cos(angle), s = std::sin(angle);
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const double x = (i + 0.01 * random.uniform()) / columns, z = 0.001 * random.uniform();
      cloud.positions.push_back({x * c - z * s, (j + 0.01 * random.uniform()) / rows, x * s + z * c});
      cloud.normals.push_back(Vec3f(Vec3d{-s, 0, c}));
    }
  return cloud;
}

/// As scanners leave them: a raster leaves no cell of its plane out, which random samples do.
TEST(LocalSurface, KnowsTheAreaOfRastersAndRows) {
  for (const auto& [columns, rows] : {std::pair{80, 80}, {120, 120}, {200, 200}, {200, 50}, {280, 70}})
    for (const double angle : {0.0, 0.5}) {
      const AreaCoverage coverage = around(raster(columns, rows, angle)).coverage;
      EXPECT_NEAR(coverage.area, 1, 0.2) << columns << " x " << rows << ", turned by " << angle;
      EXPECT_NEAR(coverage.spacing, std::sqrt(1.0 / (columns * rows)), 0.2 * std::sqrt(1.0 / (columns * rows)));
    }
}

TEST(LocalSurface, CopiesMoveNoSpacing) {
  const PointCloud once = sphere(20000);
  PointCloud copies = once;
  Random random(7);
  for (int k = 0; k < 5; ++k)
    for (size_t i = 0; i < once.size(); ++i) {
      const Vec3d shift{random.uniform(), random.uniform(), random.uniform()};
      copies.positions.push_back(once.positions[i] + shift * 1e-7);
      copies.normals.push_back(once.normals[i]);
    }
  const double spacing = around(once).coverage.spacing;
  EXPECT_NEAR(around(copies).coverage.spacing, spacing, 0.05 * spacing);
}

TEST(LocalSurface, KeepsTheSidesOfASheetApart) {
  PointCloud sheet;
  add_square(sheet, 10000, 0, -1, 1);
  add_square(sheet, 10000, 0.012, 1, 2);  // 1.2 times the spacing
  const LocalSurface surface = around(sheet);
  EXPECT_GT(static_cast<double>(surface.planes), 0.9 * static_cast<double>(sheet.size()));
  EXPECT_NEAR(surface.coverage.area, 2, 0.4);
  EXPECT_NEAR(surface.coverage.spacing, 0.01, 0.0015);
}

/// Seen from all sides, rods as thick as their samples are apart lie in no plane, whatever their cells look like; but
/// where they are sampled more thinly than the rest, they count for their area.
TEST(LocalSurface, RodsAreNoPlanesAndCount) {
  PointCloud cloud;
  add_square(cloud, 40000, 0, 1, 1);
  const size_t square = cloud.size();
  Random random(5);
  constexpr double pi = 3.14159265358979;
  for (int i = 0; i < 300; ++i) {
    const double angle = 2 * pi * random.uniform();
    const Vec3d out{std::cos(angle), std::sin(angle), 0};
    cloud.positions.push_back(Vec3d{0.5, 0.5, 0.2 + 0.8 * random.uniform()} + out * 0.03);
    cloud.normals.push_back(static_cast<Vec3f>(out));
  }
  const LocalSurface surface = around(cloud);
  const std::vector<float> weights = weigh_by_area(surface, 50, 1, one_thread);
  size_t planes = 0, heavy = 0;
  for (size_t i = square; i < cloud.size(); ++i) planes += surface.is_plane(i), heavy += weights[i] > 2;
  EXPECT_LT(planes, 60u);
  EXPECT_GT(heavy, 150u);
}

TEST(LocalSurface, IsTheSameForAnyNumberOfThreads) {
  const PointCloud cloud = sphere(50000);
  const LocalSurface one = around(cloud), three = around(cloud, Context(3));
  EXPECT_EQ(one.area, three.area);
  EXPECT_EQ(one.spacing, three.spacing);
  EXPECT_EQ(one.normal, three.normal);
}

/// Random samples that are even on the whole: most weigh one, the others nearly, and the mean stays.
TEST(AreaWeights, EvenSamplesWeighAboutOne) {
  std::vector<float> weights = weigh_by_area(around(sphere(20000)), 50, 1, one_thread);
  const size_t count = weights.size();
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0) / static_cast<double>(count), 1, 0.05);
  EXPECT_GT(static_cast<size_t>(std::count(weights.begin(), weights.end(), 1.0F)), count * 6 / 10);
  std::sort(weights.begin(), weights.end());
  EXPECT_GT(weights[count / 20], 0.7);
  EXPECT_LT(weights[count - count / 20], 1.35);
}

/// Outliers around a shape, their directions random: none counts for more than a sample of the shape does.
TEST(AreaWeights, OutliersNeverOutweigh) {
  for (const double share : {0.1, 0.4}) {
    const auto shape = make_sphere();
    SamplingParams params{.count = 20000, .outliers = share};
    const PointCloud cloud = sample_surface(*shape, params, one_thread);
    const std::vector<float> weights = weigh_by_area(around(cloud), 50, 1, one_thread);
    size_t outliers = 0;
    double heavy = 0, sum = 0;
    for (size_t i = 0; i < cloud.size(); ++i) {
      if (shape->distance(cloud.positions[i]) < 0.01) continue;
      ++outliers;
      sum += weights[i];
      heavy += weights[i] > 2;
    }
    EXPECT_LE(sum, 1.1 * static_cast<double>(outliers)) << share;
    EXPECT_LE(heavy, 0.01 * static_cast<double>(outliers)) << share;
  }
}

/// Two squares side by side, one sampled 25 times more densely: their weights' sums agree within what is taken as even.
TEST(AreaWeights, AnAreaCountsAlikeHoweverDenselySampled) {
  PointCloud cloud;
  add_square(cloud, 25000, 0, 1, 1);
  const size_t dense = cloud.size();
  add_square(cloud, 1000, 0, 1, 2);
  for (size_t i = dense; i < cloud.size(); ++i) cloud.positions[i].x += 1.3;
  cloud.positions.push_back({0, 0, 1});  // spans a volume
  cloud.normals.push_back({0, 0, 1});
  const std::vector<float> weights = weigh_by_area(around(cloud), 50, 1, one_thread);
  double of_dense = 0, of_sparse = 0;
  for (size_t i = 0; i + 1 < weights.size(); ++i) (i < dense ? of_dense : of_sparse) += weights[i];
  EXPECT_GT(of_sparse, of_dense / 3);
  EXPECT_LT(of_sparse, of_dense * 3);
  EXPECT_LE(weights.back(), 1);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
