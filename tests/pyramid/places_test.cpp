// Levels in some places of their box.
#include <gtest/gtest.h>

#include <memory>

#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"
#include "soapfilm/pyramid/solve_in_places.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/labels.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);
constexpr double lambda = 0.1;

PrimalDualParams precisely() {
  PrimalDualParams params;
  params.tolerance = 1e-4;
  return params;
}

/// A knot on a level and on the next finer one; `placed` is the solution of the first.
struct Knot {
  PointCloud cloud = sampled("knot", 128, 1);
  Problem coarse = make_problem(cloud, lattice_of(cloud, 70));
  Lattice refined = coarse.lattice.refined(1);
  PyramidSolution placed = solve(coarse, 4 * lambda, 1e-4);
  SupportField data = divergence_field(samples(), refined.box(0), one_thread);

  GridSamples samples() const { return sort_samples(cloud, cloud.normals, refined, one_thread); }
  /// The labels of the finer level by itself.
  Labels usual() const {
    const Problem fine{refined, samples(), divergence_field(samples(), refined.box(0), one_thread)};
    return labels_of(solve(fine, lambda, 1e-4).finest, 0.5f, one_thread);
  }
  /// The bricks of the finer level in this share of the box, along x.
  std::shared_ptr<const BrickMask> below(double share) const {
    const LevelBox box = refined.box(0);
    auto places = std::make_shared<BrickMask>(box.bricks);
    BrickRange::whole(box.bricks).for_each([&](Vec3i b) {
      if (parent_of(b).x < share * box.bricks.x / 2) places->set(b);
    });
    return places;
  }
};

size_t differing(const Level& level, const Labels& labels, const BrickMask& where) {
  size_t count = 0;
  for (size_t b = 0; b < labels.grid.size(); ++b) {
    const Vec3i at = labels.grid.coord(b);
    if (!where.test(at)) continue;
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = vertex_in_brick(i);
      count += labels.bits[b].test(v.x, v.y, v.z) != (level.u_at(at * brick_side + v) > 0.5f);
    }
  }
  return count;
}

/// The whole box as places: the solution of the finer level by itself.
TEST(Places, TheWholeBoxHasTheUsualSolution) {
  const Knot knot;
  LevelReport report;
  const auto whole = std::make_shared<const BrickMask>(BrickMask::whole(knot.refined.box(0).bricks));
  const Level level =
      solve_in_places(knot.placed.finest, knot.refined.box(0), whole, knot.data, precisely(), one_thread, report);
  const Labels labels = knot.usual();
  const size_t faces = count_faces(labels, one_thread);
  EXPECT_GT(faces, 5000u);
  EXPECT_LT(differing(level, labels, *whole), faces / 200);
  EXPECT_GT(report.iterations, 0);
}

/// Half of the box: away from their end the places have the whole solution, too; the level has no bricks beyond.
TEST(Places, AHalfHasTheSolutionOfTheWhole) {
  const Knot knot;
  LevelReport report;
  const auto half = knot.below(0.5), inner = knot.below(0.4);
  const Level level =
      solve_in_places(knot.placed.finest, knot.refined.box(0), half, knot.data, precisely(), one_thread, report);
  EXPECT_TRUE(level.inside.are_by_brick());
  for (size_t b = 0; b < level.grid.size(); ++b) ASSERT_TRUE(half->test(level.grid.coord(b)));
  const Labels labels = knot.usual();
  EXPECT_LT(differing(level, labels, *inner), count_faces(labels, one_thread) / 200);
  EXPECT_TRUE(level.f == &knot.data.f) << "the pull at the end stays";
  // For any number of threads.
  LevelReport again;
  const Level two =
      solve_in_places(knot.placed.finest, knot.refined.box(0), half, knot.data, precisely(), Context(2), again);
  ASSERT_EQ(two.grid.size(), level.grid.size());
  for (size_t b = 0; b < level.grid.size(); ++b)
    ASSERT_TRUE(std::equal(level.u.brick(b), level.u.brick(b) + brick_volume, two.u.brick(b)));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
