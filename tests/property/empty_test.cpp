// The empty surface as a possible optimum: what happens when it is the optimum, and the lambda at which it becomes so.
#include <gtest/gtest.h>

#include "soapfilm/reconstruct.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

Reconstruction reconstructed(const PointCloud& cloud, double lambda) {
  ReconstructParams params;
  params.place.resolution = 60;
  params.energy.lambda = lambda;
  return reconstruct(cloud, params, Context(1));
}

class EmptyOptimumOf : public testing::TestWithParam<std::string> {};

TEST_P(EmptyOptimumOf, NamesTheLargestLambdaThatKeepsASurface) {
  const PointCloud cloud = sampled(GetParam(), 60, 0.2);
  double largest = 0;
  try {
    reconstructed(cloud, 0.2);
    FAIL() << "lambda as large as the density left a surface";
  } catch (const EmptyResult& empty) {
    largest = empty.largest_lambda;
    const std::string message = empty.what();
    EXPECT_NE(message.find("lambda = 0.2"), std::string::npos) << message;
    EXPECT_NE(message.find("largest lambda"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  ASSERT_GT(largest, 0);
  EXPECT_GT(reconstructed(cloud, 0.97 * largest).mesh.triangles.size(), 100u);
  EXPECT_THROW(reconstructed(cloud, 1.1 * largest), EmptyResult);
}

INSTANTIATE_TEST_SUITE_P(Shapes, EmptyOptimumOf, testing::Values("sphere", "torus", "part"),
                         [](const auto& s) { return s.param + "_Slow"; });

TEST(EmptyOptimum, IsAnnouncedByAWarningWhenNear) {
  const PointCloud cloud = sampled("sphere", 60, 0.2);
  EXPECT_FALSE(reconstructed(cloud, 0.02).report.warnings.empty());
  EXPECT_TRUE(reconstructed(cloud, 0.004).report.warnings.empty());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
