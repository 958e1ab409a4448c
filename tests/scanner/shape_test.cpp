#include "tools/scanner/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "support/sanitized.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/sample_surface.h"

namespace soapfilm {
namespace TEST_FILE {

Vec3d random_point(Random& random, const Box3d& box, double margin) {
  const Vec3d size = box.size();
  const auto between = [&](double lo, double length) { return lo + length * random.uniform(-margin, 1.0 + margin); };
  const double x = between(box.lo.x, size.x), y = between(box.lo.y, size.y), z = between(box.lo.z, size.z);
  return {x, y, z};
}

Vec3d random_direction(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return normalized(Vec3d{x, y, z});
}

/// The finest tessellation that the tests use, made once per shape.
const Mesh& fine_mesh(const std::string& name) {
  static std::map<std::string, Mesh> made;
  const auto [entry, is_new] = made.try_emplace(name);
  if (is_new) entry->second = make_shape(name)->tessellate(2e-5);
  return entry->second;
}

class EveryShape : public testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const Shape> shape = make_shape(GetParam());
};

TEST_P(EveryShape, FillsABoxOfTheGivenSize) {
  const Mesh mesh = shape->tessellate(1e-4);
  EXPECT_DOUBLE_EQ(shape->box().longest(), 1.0);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(mesh.box().lo[axis], shape->box().lo[axis], 1e-3);
    EXPECT_NEAR(mesh.box().hi[axis], shape->box().hi[axis], 1e-3);
    EXPECT_GE(mesh.box().lo[axis], shape->box().lo[axis] - 1e-9);
    EXPECT_LE(mesh.box().hi[axis], shape->box().hi[axis] + 1e-9);
  }
}

TEST_P(EveryShape, TessellationIsClosedAndHasTheStatedTopology) {
  for (const double tolerance : {1e-3, 1e-4, 2e-5}) {
    const Mesh mesh = shape->tessellate(tolerance);
    const TopologyReport report = check_topology(mesh);
    EXPECT_TRUE(report.closed() && report.manifold()) << summary(report);
    EXPECT_EQ(report.components.size(), static_cast<size_t>(shape->facts().components));
    EXPECT_EQ(report.genus(), shape->facts().genus);
    for (const Vec3d& v : mesh.vertices) ASSERT_LE(std::abs(shape->signed_distance(v)), 1e-12);
  }
}

TEST_P(EveryShape, VolumeAndAreaMatchTheTessellation) {
  const Mesh& mesh = fine_mesh(GetParam());
  ASSERT_GT(mesh.volume(), 0.0);
  if (shape->facts().volume) {
    EXPECT_NEAR(mesh.volume() / *shape->facts().volume, 1.0, 3e-4);
  }
  if (shape->facts().area) {
    EXPECT_NEAR(mesh.area() / *shape->facts().area, 1.0, 3e-4);
  }
}

TEST_P(EveryShape, WallsGapsAndHolesSpanFiveCellsOfTheCoarsestGrid) {
  EXPECT_GE(shape->facts().narrowest, 0.1 * shape->box().longest());
}

TEST_P(EveryShape, DistanceAgreesWithAFineTessellation) {
  // The knot's tessellation cuts across the creases at its posts.
  const double tolerance = GetParam() == "knot" ? 2e-3 : 6e-5;
  const MeshSurface mesh(fine_mesh(GetParam()), Context(1));
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p = random_point(random, shape->box(), 0.3);
    const SurfacePoint closest = shape->closest(p);
    ASSERT_NEAR(closest.distance, mesh.distance(p), tolerance);
    ASSERT_NEAR(norm(closest.position - p), closest.distance, 1e-12);
    ASSERT_LE(shape->distance(closest.position), 1e-6);
    ASSERT_NEAR(norm(closest.normal), 1.0, 1e-12);
  }
}

TEST_P(EveryShape, DistanceChangesNoFasterThanThePoint) {
  Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const Vec3d p = random_point(random, shape->box(), 0.1);
    const Vec3d q = p + random_direction(random) * (0.05 * random.uniform());
    ASSERT_LE(std::abs(shape->signed_distance(p) - shape->signed_distance(q)), norm(p - q) + 1e-6);
  }
}

TEST_P(EveryShape, SignIsNegativeWithinTheSolidOnly) {
  // Crossing parity with the tessellation along a ray, away from the surface.
  const MeshSurface mesh(fine_mesh(GetParam()), Context(1));
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3d p = random_point(random, shape->box(), 0.1);
    if (shape->distance(p) < 2e-3) continue;
    const Vec3d direction = random_direction(random);
    int crossings = 0;
    Vec3d from = p;
    while (const std::optional<SurfacePoint> hit = mesh.intersect(from, direction)) {
      ++crossings;
      from = hit->position + direction * 1e-5;
    }
    ASSERT_EQ(shape->signed_distance(p) < 0.0, crossings % 2 == 1);
  }
}

TEST_P(EveryShape, RaysHitTheSurfaceFirstWhereTheTessellationDoes) {
  const MeshSurface mesh(fine_mesh(GetParam()), Context(1));
  Random random(4);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d origin = shape->box().center() + random_direction(random) * 2.0;
    const Vec3d direction = normalized(random_point(random, shape->box(), 0.0) - origin);
    const std::optional<SurfacePoint> hit = shape->intersect(origin, direction);
    const std::optional<SurfacePoint> meshed = mesh.intersect(origin, direction);
    if (hit) {
      ++hits;
      ASSERT_LE(shape->distance(hit->position), 1e-12);
      ASSERT_LE(norm(cross(hit->position - origin, direction)), 1e-12);
      ASSERT_NEAR(norm(hit->position - origin), hit->distance, 1e-12);
      ASSERT_LE(dot(hit->normal, direction), 1e-9);
      if (!meshed || dot(hit->normal, direction) > -0.2) continue;  // near the silhouette the two may differ
      ASSERT_NEAR(hit->distance, meshed->distance, GetParam() == "knot" ? 1e-2 : 5e-4);
    } else if (meshed) {
      ASSERT_LE(shape->distance(meshed->position), GetParam() == "knot" ? 2e-3 : 6e-5);
    }
  }
  EXPECT_GT(hits, 500);
}

TEST_P(EveryShape, ARayThatStartsInsideMeetsNothing) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Vec3d p = random_point(random, shape->box(), 0.0);
    if (shape->signed_distance(p) < -1e-6) {
      EXPECT_FALSE(shape->intersect(p, random_direction(random)));
    }
  }
}

TEST_P(EveryShape, KeepsMillimetersFiveThousandKilometresAway) {
  ShapeParams params;
  params.center = {5e6, -4e6, 3e6};
  const auto far = make_shape(GetParam(), params);
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    // Offsets that doubles near 5e6 hold exactly.
    const auto coarse = [&] { return std::ldexp(std::floor(random.uniform(-600, 600)), -10); };
    const double x = coarse(), y = coarse(), z = coarse();
    ASSERT_DOUBLE_EQ(far->signed_distance(params.center + Vec3d{x, y, z}), shape->signed_distance({x, y, z}));
  }
}

TEST_P(EveryShape, ScalesWithItsSize) {
  ShapeParams params;
  params.size = 250.0;
  const auto large = make_shape(GetParam(), params);
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const Vec3d p = random_point(random, shape->box(), 0.2);
    ASSERT_NEAR(large->signed_distance(p * 250.0), 250.0 * shape->signed_distance(p), 1e-9);
  }
  if (shape->facts().volume) {
    EXPECT_NEAR(*large->facts().volume, *shape->facts().volume * std::pow(250.0, 3), 1e-3);
  }
  EXPECT_TRUE(check_topology(large->tessellate(0.02)).manifold());
}

TEST_P(EveryShape, SurfaceSamplesAreUniformAndOnTheSurface) {
  const size_t count = test::sanitized ? 5000 : 20000;
  const PointCloud cloud = sample_surface(*shape, count, 11);
  ASSERT_EQ(cloud.size(), count);
  for (size_t i = 0; i < count; ++i) {
    ASSERT_LE(shape->distance(cloud.positions[i]), 1e-12);
    ASSERT_NEAR(norm(cloud.normals[i]), 1.0, 1e-6);
  }
  // Each octant of the box gets its share of the area.
  const Mesh& mesh = fine_mesh(GetParam());
  const auto octant = [&](Vec3d p) {
    const Vec3d c = shape->box().center() + Vec3d{0.013, 0.017, 0.011};
    return (p.x > c.x ? 1 : 0) + (p.y > c.y ? 2 : 0) + (p.z > c.z ? 4 : 0);
  };
  double area[8] = {};
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    // In pieces of a hundredth of the size: flat faces have triangles that span octants.
    const int parts = 1 + static_cast<int>(100.0 * std::max({norm(b - a), norm(c - b), norm(a - c)}));
    for (int i = 0; i < parts; ++i)
      for (int j = 0; j < 2 * (parts - i) - 1; ++j) {
        const double u = (i + (j % 2 ? 2.0 / 3 : 1.0 / 3)) / parts, v = (j / 2 + (j % 2 ? 2.0 / 3 : 1.0 / 3)) / parts;
        area[octant(a + (b - a) * u + (c - a) * v)] += 0.5 * norm(cross(b - a, c - a)) / (parts * parts);
      }
  }
  double counted[8] = {};
  for (const Vec3d& p : cloud.positions) counted[octant(p)] += 1.0;
  for (int k = 0; k < 8; ++k) {
    const double expected = area[k] / mesh.area() * static_cast<double>(count);
    EXPECT_NEAR(counted[k], expected, 4.5 * std::sqrt(expected) + 5e-3 * expected);
  }
  EXPECT_EQ(sample_surface(*shape, 100, 11).positions, sample_surface(*shape, 100, 11).positions);
  EXPECT_NE(sample_surface(*shape, 100, 11).positions, sample_surface(*shape, 100, 12).positions);
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(shape_names()),
                         [](const auto& each) { return each.param; });

TEST(Shape, SphereAndTorusHaveTheirClosedForms) {
  const auto sphere = make_sphere({.size = 2.0});
  EXPECT_DOUBLE_EQ(sphere->signed_distance({3.0, 4.0, 0.0}), 4.0);
  EXPECT_DOUBLE_EQ(sphere->signed_distance({0.0, 0.25, 0.0}), -0.75);
  EXPECT_DOUBLE_EQ(sphere->signed_distance({}), -1.0);
  EXPECT_NEAR(*sphere->facts().volume, 4.18879020478639, 1e-12);
  const auto hit = sphere->intersect({-5.0, 0.6, 0.0}, {1.0, 0.0, 0.0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 4.2, 1e-13);
  EXPECT_NEAR(hit->normal.x, -0.8, 1e-13);

  const auto torus = make_torus({.size = 2.8});
  EXPECT_NEAR(torus->signed_distance({}), 0.6, 1e-14);
  EXPECT_NEAR(torus->signed_distance({0.0, 1.0, 0.1}), -0.3, 1e-14);
  EXPECT_FALSE(torus->intersect({0.1, 0.2, 3.0}, {0.0, 0.0, -1.0}));  // through the hole
}

TEST(Shape, ArchStandsOnTwoFeetAGapApart) {
  for (const double gap : {0.05, 0.16, 0.5}) {
    const auto arch = make_arch({.gap = gap});
    const double foot = 0.5 * arch->box().size().x - 0.5 * arch->box().size().y;  // x of the right foot's axis
    EXPECT_NEAR(arch->signed_distance({0.0, 0.0, -0.2}), 0.5 * gap, 1e-14) << "halfway between the feet";
    EXPECT_NEAR(arch->signed_distance({foot, 0.0, -0.7}), 0.2, 1e-14) << "below a foot";
    EXPECT_NEAR(arch->signed_distance({0.0, 0.0, 0.7}), 0.2, 1e-14) << "above the bend";
    EXPECT_NEAR(arch->signed_distance({foot, 0.0, -0.2}), -0.5 * arch->box().size().y, 1e-14) << "on the axis";
    EXPECT_NEAR(arch->tessellate(2e-5).volume() / *arch->facts().volume, 1.0, 3e-4);
    EXPECT_EQ(check_topology(arch->tessellate(1e-4)).genus(), 0);
  }
}

TEST(Shape, PartIsSharp) {
  const auto part = make_part();
  const Vec3d corner = part->box().lo;
  const Vec3d out = normalized(Vec3d{-1.0, -2.0, -3.0});
  EXPECT_NEAR(part->signed_distance(corner + out * 0.2), 0.2, 1e-14);
  const SurfacePoint closest = part->closest(corner + out * 0.2);
  EXPECT_NEAR(norm(closest.position - corner), 0.0, 1e-14);
}

TEST(Shape, ThicknessAndGapAreTheCallersChoice) {
  const double three_voxels = 3.0 / 52.0;
  const auto plate = make_plate({.thickness = three_voxels});
  EXPECT_NEAR(plate->box().size().z, three_voxels, 1e-15);
  EXPECT_NEAR(plate->signed_distance({}), -0.5 * three_voxels, 1e-15);
  const auto sheets = make_sheets({.thickness = 0.05, .gap = 0.03});
  EXPECT_NEAR(sheets->signed_distance({}), 0.015, 1e-15);
  EXPECT_NEAR(sheets->box().size().z, 0.13, 1e-15);
}

TEST(Shape, RefusalsNameTheValueAndItsConstraint) {
  const auto message = [](const std::string& name, const ShapeParams& params) -> std::string {
    try {
      make_shape(name, params);
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message("cube", {}), "shape = cube, must be one of sphere, torus, part, plate, sheets, knot, arch");
  EXPECT_EQ(message("sphere", {.size = -1.0}), "size = -1, must be > 0");
  EXPECT_EQ(message("plate", {.thickness = 0.7}), "thickness = 0.7, must be in [0.0001, 0.5] times the size");
  EXPECT_EQ(message("sheets", {.gap = 0.0}), "gap = 0, must be in [0.0001, 0.5] times the size");
  EXPECT_EQ(message("torus", {.center = {0.0, NAN, 0.0}}), "center: its coordinates must be finite");
  EXPECT_THROW(make_sphere()->tessellate(0.0), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
