#include "tools/measure/section.h"

#include <gtest/gtest.h>

#include "measure/solids.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

constexpr double pi = std::numbers::pi;

TEST(Section, ASphereHasCirclesAsSections) {
  const Mesh mesh = make_sphere({.size = 2})->tessellate(1e-4);
  for (const double h : {-0.7, 0.0, 0.4}) {
    const Section s = section(mesh, {{0, 0, h}, {0, 0, 1}});
    ASSERT_EQ(s.contours.size(), 1u) << h;
    EXPECT_TRUE(s.closed());
    EXPECT_NEAR(s.area(), pi * (1 - h * h), 1e-3);
    EXPECT_NEAR(s.length(), 2 * pi * std::sqrt(1 - h * h), 1e-3);
    for (const Vec3d& p : s.contours[0].points) EXPECT_NEAR(p.z, h, 1e-12);
  }
  EXPECT_TRUE(section(mesh, {{0, 0, 1.5}, {0, 0, 1}}).contours.empty());
}

TEST(Section, HolesRunTheOtherWay) {
  const auto torus = make_torus({.size = 2});
  const Mesh mesh = torus->tessellate(1e-4);
  const double ring = 1 / 1.4, tube = 0.4 / 1.4;
  for (const Vec3d normal : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}}) {
    const Section s = section(mesh, {{}, normal});
    ASSERT_EQ(s.contours.size(), 2u);
    EXPECT_NEAR(s.area(), pi * (std::pow(ring + tube, 2) - std::pow(ring - tube, 2)), 1e-3);
    const double first = Section{s.plane, {s.contours[0]}}.area(), second = Section{s.plane, {s.contours[1]}}.area();
    EXPECT_LT(first * second, 0);
  }
}

TEST(Section, AreasAlongADirectionSumUpToTheVolume) {
  for (const char* name : {"part", "knot"}) {
    const Mesh mesh = make_shape(name)->tessellate(5e-3);
    const Vec3d normal = normalized(Vec3d{0.2, -0.3, 1});
    constexpr int slices = 400;
    double volume = 0;
    for (int i = 0; i < slices; ++i) {
      const double h = -1 + 2 * (i + 0.5) / slices;
      const Section s = section(mesh, {normal * h, normal});
      EXPECT_TRUE(s.closed());
      volume += s.area() * 2 / slices;
    }
    EXPECT_NEAR(volume, mesh.volume(), 1e-3 * mesh.volume()) << name;
  }
}

TEST(Section, PlanesThroughVerticesAndFacesLeaveNothingOpen) {
  const Mesh box = box_mesh({0, 0, 0}, {2, 3, 4});
  const struct {
    double z, area;
  } cases[] = {{-1, 0}, {0, 0}, {2, 6}, {4, 6}, {5, 0}};  // what lies on the plane is above it
  for (const auto& c : cases) {
    const Section s = section(box, {{0, 0, c.z}, {0, 0, 1}});
    EXPECT_TRUE(s.closed());
    EXPECT_NEAR(s.area(), c.area, 1e-12) << c.z;
  }
  // Through four corners, and a corner alone.
  EXPECT_NEAR(section(box, {{}, normalized(Vec3d{3, -2, 0})}).area(), std::sqrt(13.0) * 4, 1e-12);
  const Section tip = section(box, {{2, 3, 4}, normalized(Vec3d{1, 1, 1})});
  EXPECT_TRUE(tip.contours.empty());
  const Mesh part = make_part()->tessellate(1e-2);
  for (size_t i = 0; i < part.vertices.size(); i += part.vertices.size() / 100)
    for (const Vec3d normal : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, normalized(Vec3d{1, 2, 3})})
      EXPECT_TRUE(section(part, {part.vertices[i], normal}).closed());
}

TEST(Section, AnOpenMeshHasLinesWithEnds) {
  const Mesh sheet = relief(8, 4, [](double x, double y) { return x + 0.1 * y; });
  const Section s = section(sheet, {{0, 0, 2.05}, {0, 0, 1}});
  ASSERT_EQ(s.contours.size(), 1u) << "one line, from border to border";
  EXPECT_FALSE(s.closed());
  EXPECT_EQ(s.area(), 0);
  EXPECT_NEAR(s.length(), std::sqrt(16 + 0.16), 1e-9);
  // The solid, below the sheet, is to the left: it is where x is larger.
  EXPECT_LT(s.contours[0].points.back().y, s.contours[0].points.front().y);
}

TEST(Section, IsTheSameAfterAMotion) {
  const Mesh mesh = make_part()->tessellate(1e-3);
  const Plane plane{{0.01, 0.02, 0.03}, normalized(Vec3d{1, 0.2, 0.4})};
  const Section here = section(mesh, plane);
  Random random(5);
  for (int i = 0; i < 5; ++i) {
    const Motion m = random_motion(random, 1e6);
    const Section there = section(moved(mesh, m), {m.point(plane.point), m.vector(plane.normal)});
    EXPECT_EQ(there.contours.size(), here.contours.size());
    EXPECT_NEAR(there.area(), here.area(), 1e-8);
    EXPECT_NEAR(there.length(), here.length(), 1e-6);
  }
}

TEST(Section, AxesAreRightHandedAndTheFirstIsLevel) {
  for (const Vec3d normal : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, Vec3d{1, 0, 0}, normalized(Vec3d{1, -2, 3})}) {
    const PlaneAxes axes = axes_of({{}, normal});
    EXPECT_NEAR(norm(cross(axes.right, axes.up) - normal), 0, 1e-12);
    EXPECT_NEAR(axes.right.z, 0, 1e-12);
  }
  EXPECT_EQ(axes_of({}).right, (Vec3d{1, 0, 0}));
  EXPECT_EQ(axes_of({}).up, (Vec3d{0, 1, 0}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
