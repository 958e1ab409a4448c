// Parts sampled 50 times more thinly than the rest: found where samples determine them, nothing found elsewhere.
#include "soapfilm/select/thin_parts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "soapfilm/core/error.h"
#include "soapfilm/evaluate/topology.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/scanner/missing.h"
#include "soapfilm/scanner/virtual_scan.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr int resolution = 76;  // 64 voxels along the shape: the thin half of the thinnest is sampled every 3 voxels
constexpr double dense = 7;     // samples per voxel^2; a fiftieth of it is 0.14
constexpr double thinning = 50;

PointCloud thinned(const std::string& shape, double density = dense, double thin_half = thinning) {
  const auto surface = make_shape(shape);
  PointCloud cloud = sampled(*surface, resolution, density);
  if (thin_half > 1) cloud.filter(kept_samples(*surface, cloud, {.thin_half = thin_half}, Parallel(1)));
  return cloud;
}

/// Outliers anywhere in a box half as large again, looking anywhere.
void add_outliers(PointCloud& cloud, double share) {
  Random random(11);
  const Box3d box = outlier_box(cloud.box());
  const auto outliers = static_cast<size_t>(share * static_cast<double>(cloud.size()));
  for (size_t i = 0; i < outliers; ++i) {
    Vec3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(box.lo[axis], box.hi[axis]);
    cloud.positions.push_back(p);
    cloud.normals.push_back(Vec3f(normalized(Vec3d{random.normal(), random.normal(), random.normal()})));
  }
  if (!cloud.scans.empty()) cloud.scans.back().end = cloud.size();
}

std::vector<float> weights_of(const PointCloud& cloud, ThinPartsReport& report, int threads = 1) {
  const Lattice finest = lattice_of(cloud, resolution);
  Progress progress;
  return weigh_thin_parts(cloud, cloud.normals, finest, measure_sampling(cloud, Parallel()),
                          EnergyParams{}.lambda_per_density, {}, {}, Parallel(threads), progress, report);
}

Reconstruction reconstructed(const PointCloud& cloud, bool keep, int threads = 1) {
  ReconstructParams params;
  params.place.resolution = resolution;
  params.thin.keep = keep;
  params.surface.refine = false;  // topology is the segmentation's
  Progress progress;
  return reconstruct(cloud, params, Parallel(threads), progress);
}

class ThinnedShape : public testing::TestWithParam<const char*> {};

TEST_P(ThinnedShape, KeepsItsComponentsAndGenus) {
  const auto shape = make_shape(GetParam());
  const Reconstruction result = reconstructed(thinned(GetParam()), true);
  const TopologyReport topology = check_topology(result.mesh);
  EXPECT_TRUE(topology.watertight());
  EXPECT_EQ(topology.components.size(), static_cast<size_t>(shape->facts().components));
  EXPECT_EQ(topology.genus(), shape->facts().genus);
  ASSERT_TRUE(result.report.thin);
  EXPECT_FALSE(result.report.thin->parts.empty());
}

INSTANTIATE_TEST_SUITE_P(Shapes, ThinnedShape, testing::Values("sphere", "torus", "plate", "sheets", "part", "knot"),
                         [](const auto& shape) { return std::string(shape.param); });

TEST(ThinParts, AreLostWithoutTheProbe) {
  const Reconstruction result = reconstructed(thinned("torus"), false);
  EXPECT_FALSE(result.report.thin);
  EXPECT_EQ(check_topology(result.mesh).genus(), 0);
}

TEST(ThinParts, TheirSamplesWeighAsMuchPerAreaAsTheMean) {
  const PointCloud cloud = thinned("torus");
  ThinPartsReport report;
  const std::vector<float> weights = weights_of(cloud, report);
  ASSERT_EQ(weights.size(), cloud.size());
  ASSERT_EQ(report.parts.size(), 1u);
  EXPECT_NEAR(report.parts[0].density, 1 / thinning, 0.3 / thinning);
  EXPECT_GT(report.parts[0].agreement, 0.8);
  // Only the thin half's samples, most of them, and all on its side of the middle.
  const double middle = cloud.box().centre().x;
  size_t thin = 0, weighed = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const bool beyond = cloud.positions[i].x > middle;
    thin += beyond;
    weighed += weights[i] > 1;
    EXPECT_TRUE(beyond || weights[i] == 1.0f) << "sample " << i;
    EXPECT_GE(weights[i], 1.0f);
    EXPECT_LE(weights[i], ThinPartsParams{}.most_weight);
  }
  EXPECT_EQ(weighed, report.samples);
  EXPECT_GT(static_cast<double>(weighed), 0.8 * static_cast<double>(thin));
  EXPECT_NEAR(report.mean_weight, thinning, 0.3 * thinning);
}

TEST(ThinParts, FindsNoneWhereSamplingIsEven) {
  for (const char* shape : {"sphere", "plate"})
    for (const double density : {0.5, 1.0, 7.0}) {
      ThinPartsReport report;
      EXPECT_TRUE(weights_of(thinned(shape, density, 1), report).empty()) << shape << ", " << density;
      EXPECT_EQ(report.samples, 0u);
    }
}

TEST(ThinParts, AreNotWhatOutliersMake) {
  for (const char* shape : {"torus", "sheets"})
    for (const double share : {0.01, 0.1, 0.3}) {
      PointCloud cloud = thinned(shape, 1, 1);
      add_outliers(cloud, share);
      ThinPartsReport report;
      EXPECT_TRUE(weights_of(cloud, report).empty()) << shape << ", " << share;
    }
}

TEST(ThinParts, AreNotWhatNoiseMakes) {
  for (const double noise_vox : {0.5, 1.0}) {
    PointCloud cloud = thinned("torus", 1, 1);
    add_noise(cloud, noise_vox * voxel_of_resolution(cloud.box(), resolution, 6), 7);
    ThinPartsReport report;
    EXPECT_TRUE(weights_of(cloud, report).empty()) << noise_vox;
  }
}

TEST(ThinParts, AreFoundAmongOutliers) {
  PointCloud cloud = thinned("sphere");
  const size_t inliers = cloud.size();
  add_outliers(cloud, 0.01);
  ThinPartsReport report;
  const std::vector<float> weights = weights_of(cloud, report);
  ASSERT_EQ(weights.size(), cloud.size());
  EXPECT_GE(report.parts.size(), 1u);
  // An outlier that lies on the film and looks outward is a sample like others: few do.
  const auto raised = [&](size_t begin, size_t end) {
    return std::count_if(weights.begin() + static_cast<std::ptrdiff_t>(begin),
                         weights.begin() + static_cast<std::ptrdiff_t>(end), [](float w) { return w > 1; });
  };
  EXPECT_GT(raised(0, inliers), 100);
  EXPECT_LT(raised(inliers, cloud.size()), static_cast<std::ptrdiff_t>((cloud.size() - inliers) / 10));
}

TEST(ThinParts, DoNotDependOnTheNumberOfThreads) {
  const PointCloud cloud = thinned("sheets");
  ThinPartsReport report;
  const std::vector<float> expected = weights_of(cloud, report);
  ASSERT_FALSE(expected.empty());
  for (const int threads : {2, 3, 8}) {
    ThinPartsReport other;
    EXPECT_EQ(weights_of(cloud, other, threads), expected) << threads << " threads";
  }
}

TEST(ThinParts, AGivenLambdaIsNotSecondGuessed) {
  const PointCloud cloud = thinned("sphere", 1, 1);
  ReconstructParams params;
  params.place.resolution = resolution;
  params.energy.lambda = 0.02;
  params.surface.refine = false;
  Progress progress;
  EXPECT_FALSE(reconstruct(cloud, params, Parallel(1), progress).report.thin);
}

TEST(ThinParts, TooFewSamplesAreNotAsked) {
  const PointCloud cloud = thinned("sphere", 0.005, 1);
  ASSERT_LT(cloud.size(), 80u);
  ThinPartsReport report;
  EXPECT_TRUE(weights_of(cloud, report).empty());
}

TEST(ThinParts, ParametersOutOfRangeAreNamed) {
  const auto message = [](const ThinPartsParams& params) -> std::string {
    try {
      validate(params);
    } catch (const ParameterError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(message({}), "");
  EXPECT_EQ(message({.max_resolution = 16}), "max_resolution = 16, must be between 32 and 512");
  EXPECT_EQ(message({.lambda_ratio = 1}), "lambda_ratio = 1, must be > 0 and < 1");
  EXPECT_EQ(message({.thinness = 0.5}), "thinness = 0.5, must be >= 1");
  EXPECT_EQ(message({.agreement = 0}), "agreement = 0, must be > 0 and < 1");
  EXPECT_EQ(message({.least_samples = 0}), "least_samples = 0, must be > 0");
  EXPECT_EQ(message({.most_weight = 0.5}), "most_weight = 0.5, must be >= 1");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
