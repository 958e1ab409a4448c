#include "soapfilm/border/walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "soapfilm/core/random.h"
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

/// Six caps of 20 degrees have that share of a sphere.
TEST(Walls, EvenDirectionsHaveNoAxes) {
  const double caps = 3 * (1 - std::cos(M_PI / 9));
  EXPECT_NEAR(share_along_axes(even_directions(20000), one_thread), caps, 0.03);
}

TEST(Walls, ABoxInAnyPoseHasThem) {
  const Vec3d a = normalized(Vec3d{1, 2, 3}), b = normalized(cross(a, Vec3d{1, 0, 0})), c = cross(a, b);
  std::vector<Vec3f> directions;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d axis = i % 3 == 0 ? a : i % 3 == 1 ? b : c;
    directions.push_back(static_cast<Vec3f>(i % 2 == 0 ? axis : -axis));
  }
  EXPECT_NEAR(share_along_axes(directions, one_thread), 1, 1e-6);
  EXPECT_TRUE(look_along_walls(directions, one_thread));
}

/// Directions count by their length: the area that their samples stand for.
TEST(Walls, LongDirectionsCountMore) {
  std::vector<Vec3f> directions = even_directions(5000);
  const double before = share_along_axes(directions, one_thread);
  for (Vec3f& d : directions)
    if (std::abs(d.z) > 0.95f) d = 100.0f * d;
  EXPECT_GT(share_along_axes(directions, one_thread), before + 0.5);
}

TEST(Walls, RoundBodiesHaveNone) {
  for (const char* shape : {"sphere", "torus", "knot", "arch"})
    EXPECT_FALSE(look_along_walls(sample_surface(*make_shape(shape), 20000, 1).normals, one_thread)) << shape;
  EXPECT_TRUE(look_along_walls(
      sample_surface(MeshSurface(make_room().mesh, Context(1), Faces::as_given), 20000, 1).normals, one_thread));
}

TEST(Walls, AreTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3f> normals = sample_surface(*make_shape("torus"), 20000, 1).normals;
  EXPECT_EQ(share_along_axes(normals, one_thread), share_along_axes(normals, Context(3)));
}

TEST(Walls, NothingHasNone) {
  EXPECT_EQ(share_along_axes({}, one_thread), 0);
  EXPECT_EQ(share_along_axes(std::vector<Vec3f>(5), one_thread), 0);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
