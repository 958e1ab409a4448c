#include "soapfilm/border/closing.h"

#include <gtest/gtest.h>

#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr double lambda = 0.1;
constexpr int resolution = 64;
constexpr double density = 6;  // no gaps by chance, as on coarse levels

double closing_of(const PointCloud& cloud, int threads = 1) {
  const Problem problem = make_problem(cloud, resolution);
  const Context context(threads);
  const PyramidSolution solution = solve_coarse_to_fine(problem.lattice, problem.support, lambda, {}, context);
  return closing_share(solution.finest, density, context);
}

/// A ball's samples above a height, -1 to 1.
PointCloud above(double height) {
  PointCloud cloud = sampled("sphere", resolution, density);
  const Box3d box = cloud.box();
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i)
    keep[i] = (cloud.positions[i].z - box.center().z) / (box.size().z / 2) > height;
  cloud.filter(keep);
  return cloud;
}

TEST(ClosingShare, IsNothingOfAWholeSurface) {
  for (const char* shape : {"sphere", "torus", "knot"})
    EXPECT_LT(closing_of(sampled(shape, resolution, density)), 0.02) << shape;
}

/// The disk below a cap has the area pi (1 - h^2), the cap 2 pi (1 - h). By faces a disk counts once, the cap's slopes
/// up to twice.
TEST(ClosingShare, OfACapIsThatOfTheDiskBelowIt) {
  double before = 0;
  for (const double height : {-0.8, -0.4, 0.0, 0.4, 0.7}) {
    const double disk = 1 - height * height, share = disk / (disk + 2 * (1 - height));
    const double closing = closing_of(above(height));
    EXPECT_GT(closing, 0.6 * share) << height;
    EXPECT_LT(closing, 1.15 * share) << height;
    EXPECT_GT(closing, before);
    before = closing;
  }
}

TEST(ClosingShare, ThreadsDoNotMatter) {
  const PointCloud cloud = above(0.2);
  EXPECT_EQ(closing_of(cloud, 1), closing_of(cloud, 5));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
