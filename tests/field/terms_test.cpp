#include "soapfilm/field/terms.h"

#include <gtest/gtest.h>

#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

SupportField random_field(const LevelBox& box, double share, uint64_t seed) {
  Random random(seed);
  BrickMask mask(box.bricks);
  BrickRange::whole(box.bricks).for_each([&](Vec3i b) { mask.set(b, random.uniform() < share); });
  SupportField field;
  field.grid = BrickGrid(mask, one_thread);
  field.f = Field<float>(field.grid);
  for (size_t b = 0; b < field.grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i) field.f.brick(b)[i] = static_cast<float>(random.normal());
  return field;
}

TEST(Terms, AreAddedVertexByVertex) {
  Lattice lattice;
  lattice.size = {40, 30, 50};
  const LevelBox box = lattice.box(0);
  const SupportField a = random_field(box, 0.3, 1), b = random_field(box, 0.4, 2);
  const Dense<double> da = dense_field(a, box), db = dense_field(b, box);
  for (const int threads : {1, 3}) {
    const SupportField sum = sum_of(a, b, Context(threads));
    const Dense<double> found = dense_field(sum, box);
    found.for_each([&](Vec3i v) {
      ASSERT_EQ(found[v], static_cast<double>(static_cast<float>(da[v]) + static_cast<float>(db[v])));
    });
  }
}

/// What the plan counts is what the solve gets, and directions alone are the paper's f.
TEST(Terms, HaveTheirBricksAndTheValuesOfDirections) {
  const Problem problem = make_problem(sampled("knot", 40, 1), 40);
  const LevelBox box = problem.lattice.box(0);
  const SupportField data = data_field(problem.samples, box, one_thread);
  const SupportField directions = divergence_field(problem.samples, box, one_thread);
  EXPECT_EQ(data.grid.size(), data_bricks(problem.samples, box, one_thread).count());
  const Dense<double> found = dense_field(data, box), expected = dense_field(directions, box);
  found.for_each([&](Vec3i v) { ASSERT_EQ(found[v], expected[v]); });
}

}  // namespace TEST_FILE
}  // namespace soapfilm
