#include "soapfilm/border/walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "soapfilm/core/random.h"
#include "support/shuffled.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/scene.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

const Context one_thread(1);

std::vector<Vec3f> even_directions(size_t count) {
  Random random(3);
  std::vector<Vec3f> found;
  while (found.size() < count) {
    const Vec3d v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(v) < 1 && norm(v) > 0.1) found.push_back(static_cast<Vec3f>(normalized(v)));
  }
  return found;
}

std::vector<Vec3d> some_places(size_t count) {
  Random random(9);
  std::vector<Vec3d> places;
  for (size_t k = 0; k < count; ++k) places.push_back({random.uniform(), random.uniform(), random.uniform()});
  return places;
}

/// As if each direction belonged to a place of its own.
double share_of(const std::vector<Vec3f>& directions, const Context& context = one_thread) {
  return share_along_axes(some_places(directions.size()), directions, context);
}

/// Six caps of 20 degrees have that share of a sphere.
TEST(Walls, EvenDirectionsHaveNoAxes) {
  const double caps = 3 * (1 - std::cos(M_PI / 9));
  EXPECT_NEAR(share_of(even_directions(20000)), caps, 0.03);
}

TEST(Walls, ABoxInAnyPoseHasThem) {
  const Vec3d a = normalized(Vec3d{1, 2, 3}), b = normalized(cross(a, Vec3d{1, 0, 0})), c = cross(a, b);
  std::vector<Vec3f> directions;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d axis = i % 3 == 0 ? a : i % 3 == 1 ? b : c;
    directions.push_back(static_cast<Vec3f>(i % 2 == 0 ? axis : -axis));
  }
  EXPECT_NEAR(share_of(directions), 1, 1e-6);
  EXPECT_TRUE(look_along_walls(some_places(directions.size()), directions, one_thread));
}

/// Directions count by their length: the area that their samples stand for.
TEST(Walls, LongDirectionsCountMore) {
  std::vector<Vec3f> directions = even_directions(5000);
  const double before = share_of(directions);
  for (Vec3f& d : directions)
    if (std::abs(d.z) > 0.95f) d = 100.0f * d;
  EXPECT_GT(share_of(directions), before + 0.5);
}

bool are_walls(const PointCloud& cloud) { return look_along_walls(cloud.positions, cloud.normals, one_thread); }

TEST(Walls, RoundBodiesHaveNone) {
  for (const char* shape : {"sphere", "torus", "knot", "arch"})
    EXPECT_FALSE(are_walls(sample_surface(*make_shape(shape), 20000, 1))) << shape;
  EXPECT_TRUE(are_walls(sample_surface(MeshSurface(make_room().mesh, Context(1), Faces::as_given), 20000, 1)));
}

TEST(Walls, AreTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3f> normals = sample_surface(*make_shape("torus"), 20000, 1).normals;
  EXPECT_EQ(share_of(normals), share_of(normals, Context(3)));
}

TEST(Walls, DoNotDependOnTheOrderOfTheSamples) {
  const PointCloud cloud = sample_surface(*make_shape("torus"), 60000, 1), other = test::shuffled(cloud, 2);
  EXPECT_EQ(share_along_axes(cloud.positions, cloud.normals, one_thread),
            share_along_axes(other.positions, other.normals, one_thread));
}

TEST(Walls, NothingHasNone) {
  EXPECT_EQ(share_of({}), 0);
  EXPECT_EQ(share_of(std::vector<Vec3f>(5)), 0);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
