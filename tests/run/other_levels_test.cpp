#include "soapfilm/run/other_levels.h"

#include <gtest/gtest.h>

#include <utility>

#include "soapfilm/core/random.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/pyramid/coarse_to_fine.h"

namespace soapfilm {
namespace TEST_FILE {

/// Of two balls the smaller one is dropped: the level has its sides changed, and knows where.
TEST(OtherLevels, StartFromTheLevelWithoutWhatWasDropped) {
  const Context context(2);
  const Vec3d beside{1.4, 1.4, 1.4};
  Random random(1);
  PointCloud cloud;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d way = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    cloud.positions.push_back(i % 10 == 0 ? beside + way * 0.3 : way);
    cloud.normals.push_back(Vec3f(way));
  }
  const Lattice lattice = place_lattice(cloud.box(), 0.03, 6);
  const GridSamples samples = sort_samples(cloud, cloud.normals, lattice, context);
  const SupportField field = divergence_field(samples, lattice.box(0), context);
  PyramidSolution solved = solve_coarse_to_fine(lattice, field, 0.1, {}, context);
  Labels labels = labels_of(solved.finest, 0.5f, context);
  const auto is_small = [&](Vec3i vertex) { return norm(lattice.to_world(Vec3d(vertex)) - beside) < 0.6; };
  size_t removed = 0;
  for (size_t b = 0; b < labels.grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = vertex_in_brick(i);
      if (!is_small(labels.grid.first_vertex(b) + v) || !labels.bits[b].test(v.x, v.y, v.z)) continue;
      labels.bits[b].clear(i);
      ++removed;
    }
  ASSERT_GT(removed, 100u);
  const PlacedLevel placed = with_sides(std::move(solved.finest), {}, 0.5f, labels, context);
  size_t dropped = 0;
  for (size_t b = 0; b < placed.level.grid.size(); ++b) {
    dropped += placed.dropped[b].count();
    placed.dropped[b].for_each([&](int i) {
      EXPECT_TRUE(is_small(placed.level.grid.first_vertex(b) + vertex_in_brick(i)));
      EXPECT_EQ(placed.level.u.brick(b)[i], 0);
    });
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = vertex_in_brick(i);
      ASSERT_EQ(placed.level.u.brick(b)[i] > 0.5f, labels.bits[b].test(v.x, v.y, v.z));
    }
  }
  EXPECT_EQ(dropped, removed);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
