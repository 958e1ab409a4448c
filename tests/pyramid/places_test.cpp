// Levels in some places of their box.
#include <gtest/gtest.h>

#include <memory>

#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"
#include "soapfilm/pyramid/restrict_level.h"
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

/// A level restricted has the means of u, and the divergence of its children.
TEST(Places, RestrictionKeepsMeansAndFluxes) {
  const Knot knot;
  const Level& fine = knot.placed.finest;
  const LevelBox box = knot.coarse.lattice.box(1);
  const SupportField data = restrict_field(knot.coarse.support, box, one_thread);
  const Level coarse = restrict_level(fine, box, parents_of(fine.grid, box.bricks, one_thread), data, one_thread);
  EXPECT_EQ(coarse.lambda, 4 * fine.lambda);
  const auto inflow = [](const Level& level, size_t b, Vec3i v) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float* p = level.p.brick(b, axis);
      Vec3i below = v;
      --below[axis];
      const LowFace low = low_face(level, b, axis);
      sum += (v[axis] > 0 ? p[brick_offset(below.x, below.y, below.z)]
                          : low.at(v[axis == 0 ? 1 : 0], v[axis == 2 ? 1 : 2])) -
             p[brick_offset(v.x, v.y, v.z)];
    }
    return sum;
  };
  size_t compared = 0;
  for (size_t b = 0; b < coarse.grid.size(); ++b)
    for (int k = 0; k < 8; ++k) {
      const int32_t child = fine.grid.find(child_of(coarse.grid.coord(b), k));
      if (child < 0) continue;
      for (int i = 0; i < octant_volume; ++i) {
        const Vec3i at{i % half_brick, i / half_brick % half_brick, i / (half_brick * half_brick)};
        double u = 0, in = 0;
        for (int c = 0; c < 8; ++c) {
          const Vec3i v = at * 2 + octant_of(c);
          u += fine.u.brick(static_cast<size_t>(child))[brick_offset(v.x, v.y, v.z)] / 8.0;
          in += inflow(fine, static_cast<size_t>(child), v);
        }
        const Vec3i own = octant_base(octant_of(k)) + at;
        if (!box.is_free(coarse.grid.first_vertex(b) + own)) continue;
        ASSERT_NEAR(coarse.u.brick(b)[brick_offset(own.x, own.y, own.z)], u, 1e-6);
        ASSERT_NEAR(inflow(coarse, b, own), in, 1e-4 * coarse.lambda);
        ++compared;
      }
    }
  EXPECT_GT(compared, 10000u);
}

/// Upwards: where the coarser level has no places it is the finer one's, elsewhere its own solution.
TEST(Places, ACoarserLevelGoesOnInTheFinerOne) {
  const Knot knot;
  const Level& fine = knot.placed.finest;
  const Lattice above = knot.coarse.lattice.of_level(1);
  const LevelBox box = knot.coarse.lattice.box(1);
  const Problem own = make_problem(knot.cloud, above);
  const PyramidSolution alone = solve(own, 16 * lambda, 1e-4);
  BrickMask places(box.bricks), far(box.bricks);
  BrickRange::whole(box.bricks).for_each([&](Vec3i b) {
    if (2 * b.x < box.bricks.x) places.set(b);
    if (2 * b.x > box.bricks.x + 2) far.set(b);
  });
  LevelReport report;
  const Level level =
      solve_coarser_in_places(fine, alone.finest, box, places, own.support, precisely(), one_thread, report);
  const Labels labels = labels_of(alone.finest, 0.5f, one_thread);
  EXPECT_LT(differing(level, labels, places), count_faces(labels, one_thread) / 20);
  const Level restricted =
      restrict_level(fine, box, parents_of(fine.grid, box.bricks, one_thread), own.support, one_thread);
  EXPECT_EQ(differing(level, labels_of(restricted, 0.5f, one_thread), far), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
