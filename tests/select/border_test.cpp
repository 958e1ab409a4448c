#include "soapfilm/select/border.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "soapfilm/core/error.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Parallel one_thread(1);
constexpr double lambda = 0.02;
constexpr int resolution = 96;

BorderReport chosen_for(const PointCloud& cloud, Norm norm = Norm::isotropic, int threads = 1) {
  const Problem problem = make_problem(cloud, resolution);
  Progress progress;
  return choose_border(problem.lattice, problem.support, lambda, {}, {}, norm, Parallel(threads), progress);
}

PointCloud turned(PointCloud cloud) {
  for (Vec3f& n : cloud.normals) n = -n;
  return cloud;
}

/// Those samples of a cloud that lie above a share of its box along z.
PointCloud upper_part(PointCloud cloud, double above) {
  const Box3d box = cloud.box();
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = cloud.positions[i].z > box.lo.z + above * box.size().z;
  cloud.filter(keep);
  return cloud;
}

/// Hills over a square, seen from above.
PointCloud terrain() {
  Random random(5);
  PointCloud cloud;
  constexpr int samples = 9000;
  for (int i = 0; i < samples; ++i) {
    const double x = random.uniform(), y = random.uniform();
    const double slope_x = 0.4 * std::cos(8 * x), slope_y = 0.3 * std::cos(6 * y);
    cloud.positions.push_back({x, y, 0.05 * std::sin(8 * x) + 0.05 * std::sin(6 * y)});
    cloud.normals.push_back(Vec3f(normalized(Vec3d{-slope_x, -slope_y, 1})));
  }
  cloud.scans.push_back({"terrain", 0, samples, {}, {}, {}});
  return cloud;
}

TEST(Border, ClosedObjectsHaveAirAround) {
  for (const char* shape : {"sphere", "torus", "part", "knot"}) {
    const BorderReport report = chosen_for(sampled(shape, resolution, 1));
    EXPECT_EQ(report.chosen, Border::air) << shape << ": " << report.reason;
  }
}

TEST(Border, ABottomThatNobodySawIsClosed) {
  const BorderReport report = chosen_for(upper_part(sampled("sphere", resolution, 1), 0.1));
  EXPECT_EQ(report.chosen, Border::air) << report.reason;
}

TEST(Border, WhatIsSeenFromWithinHasSolidMatterAround) {
  for (const char* shape : {"sphere", "part"}) {
    const BorderReport report = chosen_for(turned(sampled(shape, resolution, 1)));
    EXPECT_EQ(report.chosen, Border::solid) << shape << ": " << report.reason;
  }
}

TEST(Border, SheetsAreOpen) {
  for (const bool other_side : {false, true}) {
    const BorderReport report = chosen_for(other_side ? turned(terrain()) : terrain());
    EXPECT_EQ(report.chosen, Border::open) << report.reason;
    EXPECT_LT(*report.open, *report.air);
    EXPECT_LT(*report.open, *report.solid);
  }
}

/// What the dual says that another border could gain at most, none of them does.
TEST(Border, NothingGainsMoreThanTheFluxThroughTheBorder) {
  constexpr double solved_to = 0.01;
  for (const PointCloud& cloud : {terrain(), upper_part(sampled("sphere", resolution, 1), 0.5)}) {
    const BorderReport report = chosen_for(cloud);
    ASSERT_TRUE(report.open);
    const double most = *report.air * (1 + report.border_flux + solved_to);
    EXPECT_GT(*report.open, most);
    EXPECT_GT(*report.solid, most);
  }
}

TEST(Border, IsTheSameForAnyNumberOfThreads) {
  const BorderReport one = chosen_for(terrain()), many = chosen_for(terrain(), Norm::isotropic, 3);
  EXPECT_EQ(one.air, many.air);
  EXPECT_EQ(one.solid, many.solid);
  EXPECT_EQ(one.open, many.open);
}

TEST(Border, RefusesAShareOutOfRange) {
  EXPECT_THROW(validate(BorderParams{.open_gain = 0}), ParameterError);
  EXPECT_THROW(validate(BorderParams{.open_gain = 1.5}), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
