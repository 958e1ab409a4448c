#include "soapfilm/adapt/leaf_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adapt/ball_levels.h"
#include "soapfilm/extract/leaf_surface.h"
#include "soapfilm/mesh/topology.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

double ball(Vec3d q) { return 45 - norm(q - Vec3d{63, 64, 65}); }

/// Of a field only the bricks near its surface; elsewhere its side.
DistanceField near_surface(const Lattice& lattice, int level, const std::function<double(Vec3d)>& distance) {
  const DistanceField whole = field_of(lattice, level, distance);
  BrickMask near(lattice.box(level).bricks);
  for (size_t b = 0; b < whole.grid.size(); ++b) {
    const float* values = whole.value.brick(b);
    if (std::any_of(values, values + brick_volume, [](float v) { return std::abs(v) < 2; }))
      near.set(whole.grid.coord(b));
  }
  DistanceField field;
  field.grid = BrickGrid(near, one_thread);
  field.value = Field<float>(field.grid);
  for (size_t b = 0; b < field.grid.size(); ++b)
    std::copy_n(whole.value.brick(static_cast<size_t>(whole.grid.find(field.grid.coord(b)))), brick_volume,
                field.value.brick(b));
  field.inside = GapSides(field.grid, BrickRange::whole(lattice.box(level).bricks), [&](Vec3i brick) {
    return whole.value.brick(static_cast<size_t>(whole.grid.find(brick)))[0] > 0;
  });
  return field;
}

Mesh mesh_of(const Regions& regions, std::span<const DistanceField> levels, const Lattice& lattice) {
  const LeafField leaves = join_levels(regions, levels, lattice, one_thread);
  std::vector<const BrickGrid*> grids;
  std::vector<const Field<float>*> distances;
  for (size_t l = 0; l < leaves.grids.size(); ++l) {
    grids.push_back(&leaves.grids[l]);
    distances.push_back(&leaves.distances[l]);
  }
  return extract_leaf_surface(
      grids, distances, [&](int level, Vec3i v) { return side_of_region(regions, levels, level, v); }, lattice,
      one_thread);
}

TEST(LeafField, LevelsThatAgreeMakeOneSurface) {
  const Lattice lattice = small_lattice();
  const DistanceField levels[] = {near_surface(lattice, 0, ball), near_surface(lattice, 1, ball)};
  for (const int until : {3, 4, 5}) {
    const Mesh mesh = mesh_of(halves(lattice, until, until), levels, lattice);
    const TopologyReport report = check_topology(mesh);
    EXPECT_TRUE(report.closed() && report.manifold()) << until;
    EXPECT_EQ(report.components.size(), 1u);
    EXPECT_EQ(report.genus(), 0);
    double worst = 0;
    for (const Vec3d p : mesh.vertices) worst = std::max(worst, std::abs(ball(p)));
    EXPECT_LT(worst, 0.05);
  }
}

/// One level has the ball, the other nothing, or another part of it: a wall closes what is left.
TEST(LeafField, LevelsThatDoNotAgreeAreClosedByAWall) {
  const Lattice lattice = small_lattice();
  const auto smaller = [](Vec3d q) { return ball(q) - 21; };
  const auto nothing = [](Vec3d) { return -5.0; };
  const std::function<double(Vec3d)> others[] = {smaller, nothing};
  for (const auto& other : others)
    for (const int finer : {0, 1}) {
      const DistanceField levels[] = {near_surface(lattice, 0, finer == 0 ? ball : other),
                                      near_surface(lattice, 1, finer == 0 ? other : ball)};
      const Mesh mesh = mesh_of(halves(lattice, 4, 4), levels, lattice);
      const TopologyReport report = check_topology(mesh);
      EXPECT_TRUE(report.closed() && report.manifold()) << report.boundary_edges;
      EXPECT_GT(mesh.volume(), 0.45 * 4.19 * std::pow(45, 3));
    }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
