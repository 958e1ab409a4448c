#include "tools/measure/above_plane.h"

#include <gtest/gtest.h>

#include "measure/solids.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

constexpr double pi = std::numbers::pi;

TEST(AbovePlane, ABoxIsCutWhereThePlaneIs) {
  const Mesh box = box_mesh({1, 2, 3}, {3, 5, 7});
  for (const double z : {2.0, 3.0, 4.5, 7.0, 9.0}) {
    const double top = std::clamp(7 - z, 0.0, 4.0) * 6;
    const VolumeAtPlane v = volume_at_plane(box, true, {{0, 0, z}, {0, 0, 1}});
    EXPECT_NEAR(v.above, top, 1e-12) << z;
    EXPECT_NEAR(v.below, 24 - top, 1e-12) << z;
  }
  // Through the center along the diagonal of a face: half.
  const Plane oblique{{2, 3.5, 5}, normalized(Vec3d{1, -2, 0.5})};
  EXPECT_NEAR(volume_at_plane(box, true, oblique).above, 12, 1e-12);
}

TEST(AbovePlane, TheCapOfASphereConverges) {
  for (const double h : {-0.6, 0.0, 0.3}) {
    const double height = 1 - h, exact = pi * height * height * (3 - height) / 3;
    double before = 1;
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
      const Mesh mesh = make_sphere({.size = 2})->tessellate(tolerance);
      const double error = std::abs(volume_at_plane(mesh, true, {{0, 0, h}, {0, 0, 1}}).above - exact);
      EXPECT_LT(error, before / 3) << h;
      before = error;
    }
    EXPECT_LT(before, 1e-3);
  }
}

TEST(AbovePlane, AboveAndBelowAreTheWholeWhateverTheMotion) {
  const Mesh mesh = make_part()->tessellate(1e-3);
  const double volume = mesh.volume();
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Motion motion = random_motion(random, 1e6);
    const Plane plane{{0.02, -0.05, 0.01 * i - 0.1}, normalized(Vec3d{0.3, 0.1 * i, 1})};
    const VolumeAtPlane here = volume_at_plane(mesh, true, plane);
    const VolumeAtPlane there =
        volume_at_plane(moved(mesh, motion), true, {motion.point(plane.point), motion.vector(plane.normal)});
    EXPECT_NEAR(here.above + here.below, volume, 1e-12);
    EXPECT_GT(here.above, 0.05 * volume);
    EXPECT_NEAR(there.above, here.above, 1e-8);
    EXPECT_NEAR(there.below, here.below, 1e-8);
    const VolumeAtPlane turned = volume_at_plane(mesh, true, {plane.point, -plane.normal});
    EXPECT_NEAR(turned.above, here.below, 1e-12);
  }
}

TEST(AbovePlane, WindowsSideBySideAddUp) {
  const Mesh mesh = make_torus()->tessellate(1e-3);
  const Plane plane{{0, 0, 0.03}, {0, 0, 1}};
  const double all = volume_at_plane(mesh, true, plane).above;
  double sum = 0;
  for (const Window& w : {Window{-1, -1, 0.1, 0.2}, {0.1, -1, 1, 0.2}, {-1, 0.2, 0.1, 1}, {0.1, 0.2, 1, 1}}) {
    const double part = volume_at_plane(mesh, true, plane, w).above;
    EXPECT_GT(part, 0.05 * all);
    sum += part;
  }
  EXPECT_NEAR(sum, all, 1e-12);
  const Mesh box = box_mesh({0, 0, 0}, {4, 4, 2});
  for (const Vec3d at : {Vec3d{0, 0, 0.5}, Vec3d{3, -7, 0.5}})  // wherever on the plane its point is
    EXPECT_NEAR(volume_at_plane(box, true, {at, {0, 0, 1}}, Window{1, 2, 7, 3}).above, 3 * 1 * 1.5, 1e-12);
}

TEST(AbovePlane, AnOpenSheetHasVolumesOnBothSidesWhicheverWayItLooks) {
  // A ramp from -1 to 3 over 4 x 4: above it is 3 long and 3 high, below 1 and 1.
  const Mesh ramp = relief(7, 4, [](double x, double) { return x - 1; });
  for (const Mesh& mesh : {ramp, flipped(ramp)}) {
    const VolumeAtPlane v = volume_at_plane(mesh, false, {{0, 0, 0}, {0, 0, 1}});
    EXPECT_NEAR(v.above, 0.5 * 3 * 3 * 4, 1e-12);
    EXPECT_NEAR(v.below, 0.5 * 1 * 1 * 4, 1e-12);
    EXPECT_NEAR(v.footprint_above, 12, 1e-12);
    EXPECT_NEAR(v.footprint_below, 4, 1e-12);
    EXPECT_TRUE(v.is_sheet);
  }
}

TEST(AbovePlane, ABodyWithAHoleIsNoSheetWhereverTheHoleIs) {
  const Mesh torus = make_torus()->tessellate(1e-3);
  const Plane plane{{0, 0, 0}, {0, 0, 1}};
  const VolumeAtPlane whole = volume_at_plane(torus, true, plane);
  for (const double side : {-1.0, 1.0}) {  // a hole in the floor, one in the lid
    Mesh holed = torus;
    std::erase_if(holed.triangles, [&](const Triangle& t) {
      const Vec3d v = torus.vertices[t[0]];
      return v.x > 0.3 && std::abs(v.y) < 0.1 && side * v.z > 0.1;
    });
    ASSERT_LT(holed.triangles.size(), torus.triangles.size());
    const VolumeAtPlane v = volume_at_plane(holed, false, plane);
    EXPECT_FALSE(v.is_sheet);
    EXPECT_GT(v.above, 0.8 * whole.above);
    EXPECT_GT(v.below, 0.8 * whole.below);
    EXPECT_LT(v.above + v.below, whole.above + whole.below);
  }
}

TEST(AbovePlane, AnOverhangCountsOnce) {
  // A box without its floor on the plane, and one that floats: top minus underside.
  Mesh standing = box_mesh({0, 0, 0}, {2, 2, 3});
  standing.triangles.erase(standing.triangles.begin(), standing.triangles.begin() + 2);
  EXPECT_NEAR(volume_at_plane(standing, false, {{0, 0, 0}, {0, 0, 1}}).above, 12, 1e-12);
  Mesh floating = box_mesh({0, 0, 1}, {2, 2, 3});
  for (Triangle& t : floating.triangles)
    for (uint32_t& v : t) v += 8;
  floating.vertices.insert(floating.vertices.begin(), standing.vertices.begin(), standing.vertices.end());
  for (size_t k = 0; k < 8; ++k) floating.vertices[k].x += 5;
  floating.triangles.insert(floating.triangles.end(), standing.triangles.begin(), standing.triangles.end());
  EXPECT_NEAR(volume_at_plane(floating, false, {{0, 0, 0}, {0, 0, 1}}).above, 12 + 8, 1e-12);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
