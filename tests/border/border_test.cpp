#include "soapfilm/border/border.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/error.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);
constexpr double lambda = 0.02;
constexpr int resolution = 96;

BorderReport chosen_for(const PointCloud& cloud, int threads = 1, const Surroundings& scanners = {},
                        int along_box = resolution) {
  Problem problem = make_problem(cloud, along_box);
  const Problem same = make_problem(cloud, along_box);
  const BorderReport report =
      choose_border({problem.lattice, problem.support, lambda, Norm::isotropic, 1, problem.lattice.voxel}, scanners, {},
                    {}, Context(threads));
  for (size_t b = 0; b < problem.support.grid.size(); ++b)
    EXPECT_TRUE(
        std::equal(same.support.f.brick(b), same.support.f.brick(b) + brick_volume, problem.support.f.brick(b)));
  return report;
}

PointCloud reversed(PointCloud cloud) {
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
PointCloud terrain(int samples = 9000) {
  Random random(5);
  PointCloud cloud;
  for (int i = 0; i < samples; ++i) {
    const double x = random.uniform(), y = random.uniform();
    const double slope_x = 0.4 * std::cos(8 * x), slope_y = 0.3 * std::cos(6 * y);
    cloud.positions.push_back({x, y, 0.05 * std::sin(8 * x) + 0.05 * std::sin(6 * y)});
    cloud.normals.push_back(Vec3f(normalized(Vec3d{-slope_x, -slope_y, 1})));
  }
  cloud.scans.push_back({"terrain", 0, cloud.size(), {}, {}, {}});
  return cloud;
}

/// E(1 - u) of the negated data is E(u) + sum(f): evidence for the inside, linear in u, around all samples. The surface
/// that pays for none of its area is solid matter everywhere, E(1) = -sum(f).
TEST(Border, EnergiesAreComparedWithTheirConstants) {
  constexpr float evidence = 0.5;  // per vertex
  Problem problem = make_problem(sampled("sphere", resolution, 1), resolution);
  double sum = 0;
  for (size_t b = 0; b < problem.support.grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i) sum += problem.support.f.brick(b)[i] += evidence;
  const BorderReport report = choose_border(
      {problem.lattice, problem.support, lambda, Norm::isotropic, 1, problem.lattice.voxel}, {}, {}, {}, one_thread);
  ASSERT_TRUE(report.solid);
  EXPECT_LE(*report.solid, -0.9999 * sum);
  EXPECT_GE(*report.solid, -1.2 * sum);
  EXPECT_LT(*report.solid, *report.air);
  EXPECT_EQ(report.chosen, Border::solid) << report.reason;
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
    const BorderReport report = chosen_for(reversed(sampled(shape, resolution, 1)));
    EXPECT_EQ(report.chosen, Border::solid) << shape << ": " << report.reason;
  }
}

TEST(Border, SheetsAreOpen) {
  for (const bool other_side : {false, true}) {
    const BorderReport report = chosen_for(other_side ? reversed(terrain()) : terrain());
    EXPECT_EQ(report.chosen, Border::open) << report.reason;
    EXPECT_LT(*report.open, *report.air);
    EXPECT_LT(*report.open, *report.solid);
  }
}

/// From a small sheet that lies askew in its box the way to the border is long.
TEST(Border, SmallSheetsAreOpenInAnyPose) {
  const Vec3d axes[3] = {normalized(Vec3d{1, 2, 3}), normalized(cross(Vec3d{1, 2, 3}, Vec3d{1, 0, -1})),
                         normalized(cross(cross(Vec3d{1, 2, 3}, Vec3d{1, 0, -1}), Vec3d{1, 2, 3}))};
  for (const int side : {45, 70, 120}) {
    PointCloud cloud = terrain(side * side);
    for (Vec3d& p : cloud.positions) p = axes[0] * p.x + axes[1] * p.y + axes[2] * p.z;
    for (Vec3f& n : cloud.normals) n = Vec3f(axes[0] * double{n.x} + axes[1] * double{n.y} + axes[2] * double{n.z});
    const Box3d box = cloud.box();
    const int along_box = static_cast<int>(side * box.longest()) + 12;
    const BorderReport report = chosen_for(cloud, 1, {}, along_box);
    EXPECT_EQ(report.chosen, Border::open) << side << ": " << report.reason;
  }
}

/// What the dual says that another border could gain at most, none of them does.
TEST(Border, NothingGainsMoreThanTheFluxThroughTheBorder) {
  constexpr double solved_to = 0.01;
  for (const PointCloud& cloud : {terrain(), upper_part(sampled("sphere", resolution, 1), 0.5)}) {
    const BorderReport report = chosen_for(cloud);
    ASSERT_TRUE(report.open);
    const double most = *report.air * (1 + solved_to) - report.border_flux * report.area_cost;
    EXPECT_GT(*report.open, most);
    EXPECT_GT(*report.solid, most);
  }
}

/// Fewer conditions, lower energies, and a bound below them all.
TEST(Border, AnOpenSurfaceCostsNoMoreThanAClosedOne) {
  for (const PointCloud& cloud : {terrain(), reversed(terrain()), upper_part(sampled("part", resolution, 1), 0.3)}) {
    const BorderReport report = chosen_for(cloud);
    ASSERT_TRUE(report.open && report.solid && report.open_bound);
    EXPECT_LE(*report.open, *report.air);
    EXPECT_LE(*report.open, *report.solid);
    EXPECT_LE(*report.open_bound, *report.open);
  }
}

/// Both sides of the complement: no data is lost at the border.
TEST(Border, TurnedDirectionsSwapAirAndSolidMatter) {
  const PointCloud cloud = upper_part(sampled("torus", resolution, 1), 0.4);
  const BorderReport one = chosen_for(cloud), other = chosen_for(reversed(cloud));
  ASSERT_TRUE(one.solid && other.solid);
  EXPECT_NEAR(*one.air, *other.solid, 1e-3 * std::abs(*one.air));
  EXPECT_NEAR(*one.solid, *other.air, 1e-3 * std::abs(*one.solid));
  EXPECT_NEAR(*one.open, *other.open, 5e-3 * std::abs(*one.open));
}

/// A ditch that tells little of itself: two thirds of a long tube, seen from its axis.
TEST(Border, ScannersUnderAnOpenSkyMakeItOpen) {
  Random random(7);
  PointCloud ditch;
  constexpr int samples = 40000, along_box = 200;
  for (int i = 0; i < samples; ++i) {
    const double angle = random.uniform(-0.6, M_PI + 0.6), along = 8 * random.uniform();
    const Vec3d around{std::cos(angle), 0, -std::sin(angle)};
    ditch.positions.push_back(around + Vec3d{0, along, 0});
    ditch.normals.push_back(Vec3f(-around));
  }
  ditch.scans.push_back({"ditch", 0, samples, Vec3d{0, 4, 0}, {}, {}});
  const BorderReport unknown = chosen_for(ditch, 1, {}, along_box);
  EXPECT_EQ(unknown.chosen, Border::solid) << unknown.reason;
  const Surroundings scanners = measure_surroundings(ditch, {}, one_thread);
  EXPECT_TRUE(scanners.stand_among_samples());
  EXPECT_LT(scanners.covered, 0.75);
  const BorderReport known = chosen_for(ditch, 1, scanners, along_box);
  EXPECT_EQ(known.chosen, Border::open) << known.reason;
}

/// A room of 4 x 3 x 2.5, seen from within: all of its six sides.
PointCloud room(int samples) {
  const Vec3d size{4, 3, 2.5};
  Random random(9);
  PointCloud cloud;
  while (static_cast<int>(cloud.size()) < samples) {
    const int axis = static_cast<int>(random.uniform(0, 3));
    if (random.uniform(0, 12) > size.x * size.y * size.z / size[axis]) continue;
    Vec3d p{random.uniform(0, size.x), random.uniform(0, size.y), random.uniform(0, size.z)};
    Vec3f inward;
    inward[axis] = random.uniform() < 0.5 ? -1 : 1;
    p[axis] = inward[axis] > 0 ? 0 : size[axis];
    cloud.positions.push_back(p);
    cloud.normals.push_back(inward);
  }
  cloud.scans.push_back({"room", 0, cloud.size(), {}, {}, {}});
  return cloud;
}

/// The question is one of the scene, not of the grid that was asked for.
TEST(Border, TheChoiceDoesNotDependOnTheVoxel) {
  struct Case {
    const char* name;
    PointCloud cloud;
    Border chosen;
    bool ends;
  };
  for (const Case& c :
       {Case{"sphere", sampled("sphere", resolution, 1), Border::air, false},
        Case{"sheet", terrain(), Border::open, true}, Case{"room", room(25000), Border::solid, false}}) {
    constexpr int padding = 6;
    const double default_voxel = voxel_of_resolution(c.cloud.box(), resolution, padding);
    for (const double factor : {0.5, 1.0, 2.0, 4.0}) {
      Problem problem = make_problem(c.cloud, place_lattice(c.cloud.box(), factor * default_voxel, padding));
      const double density = factor * factor;
      const BorderReport report =
          choose_border({problem.lattice, problem.support, density * lambda, Norm::isotropic, density, default_voxel},
                        {}, {}, {}, Context(2));
      EXPECT_EQ(report.chosen, c.chosen) << c.name << " at " << factor << " voxels: " << report.reason;
      EXPECT_EQ(report.ends, c.ends) << c.name << " at " << factor << " voxels: " << report.reason;
    }
  }
}

TEST(Border, IsTheSameForAnyNumberOfThreads) {
  const BorderReport one = chosen_for(terrain()), many = chosen_for(terrain(), 3);
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
