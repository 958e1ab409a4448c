// Properties of the reconstructed surface, measured on shapes whose truth is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "soapfilm/mesh/topology.h"
#include "soapfilm/pyramid/restrict.h"
#include "soapfilm/reconstruct.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

Reconstruction reconstructed(const PointCloud& cloud, double voxel, double tolerance = PrimalDualParams().tolerance,
                             double split_tolerance = RelaxParams().split_tolerance,
                             Border outside = Border::automatic) {
  ReconstructParams params;
  params.border.outside = outside;
  params.surface.relax.split_tolerance = split_tolerance;
  params.place.voxel = voxel;
  params.solve.tolerance = tolerance;
  Reconstruction result = reconstruct(cloud, params, Context(1));
  EXPECT_TRUE(check_topology(result.mesh).watertight());
  return result;
}

void keep_where(PointCloud& cloud, const auto& condition) {
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = condition(cloud.positions[i]);
  cloud.filter(keep);
}

/// Mean | |vertex| - radius | over meshes of a sphere of diameter 1 around the origin, at four positions in the grid.
/// Edges are not split: that would move vertices onto the sphere that otherwise lie outside it, because of the chords.
double mean_radius_error(double voxel, size_t samples) {
  double sum = 0;
  size_t count = 0;
  for (const int k : {1, 2, 3, 4}) {
    const PointCloud cloud = sample_surface(*make_sphere(), samples, static_cast<uint64_t>(k));
    const Reconstruction result = reconstructed(cloud, voxel * (1 + 0.01 * k), PrimalDualParams().tolerance, 0);
    for (const Vec3d& v : result.mesh.vertices) sum += std::abs(norm(v) - 0.5);
    count += result.mesh.vertices.size();
  }
  return sum / static_cast<double>(count);
}

TEST(Sphere, RadiusErrorHalvesWhenTheVoxelHalvesAndSamplesQuadrupleSlow) {
  const double coarse = mean_radius_error(1.0 / 24, 3000);
  const double middle = mean_radius_error(1.0 / 48, 12000);
  const double fine = mean_radius_error(1.0 / 96, 48000);
  EXPECT_LT(coarse * 24, 0.15) << "in voxels";
  EXPECT_LE(middle, 0.5 * coarse);
  EXPECT_LE(fine, 0.5 * middle);
}

/// Area of the mesh within `radius` of an axis through `center`, on the side where the axis points.
double area_of_cap(const Mesh& mesh, Vec3d center, Vec3d axis, double radius) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    const Vec3d m = (a + b + c) / 3.0 - center;
    const double height = dot(m, axis);
    if (norm(m - axis * height) > radius || height < -radius) continue;
    area += 0.5 * norm(cross(b - a, c - a));
  }
  return area;
}

/// Rotates about a skew axis, so that the hole's plane is no lattice plane.
Vec3d rotated(Vec3d p) {
  const Vec3d axis = normalized(Vec3d{1, 2, 3});
  const double angle = 0.7;
  return p * std::cos(angle) + cross(axis, p) * std::sin(angle) + axis * (dot(axis, p) * (1 - std::cos(angle)));
}

class PlanarHole : public testing::TestWithParam<bool> {};

TEST_P(PlanarHole, OfTwentyVoxelsIsClosedByAPatchOfTheDisc) {
  const bool skew = GetParam();
  constexpr double voxel = 1.0 / 60, radius = 10 * voxel;
  const auto box = make_plate({.thickness = 0.5});  // 1 x 0.7 x 0.5, edges rounded
  PointCloud cloud = sample_surface(*box, 12000, 1);
  const Vec3d top{0, 0, 0.25};
  keep_where(cloud, [&](Vec3d p) { return p.z < 0.2 || std::hypot(p.x, p.y) > radius; });
  if (skew)
    cloud = transformed(
        cloud, [](Vec3d p) { return rotated(p); }, [](Vec3f n) { return Vec3f(rotated(Vec3d(n))); });
  const Reconstruction result = reconstructed(cloud, voxel);
  EXPECT_EQ(check_topology(result.mesh).components.size(), 1u);
  EXPECT_EQ(check_topology(result.mesh).genus(), 0);
  const Vec3d center = skew ? rotated(top) : top, axis = skew ? rotated({0, 0, 1}) : Vec3d{0, 0, 1};
  const double disc = std::numbers::pi * radius * radius;
  EXPECT_NEAR(area_of_cap(result.mesh, center, axis, radius), disc, 0.03 * disc);
}

INSTANTIATE_TEST_SUITE_P(Planes, PlanarHole, testing::Bool(), [](const auto& p) { return p.param ? "skew" : "axis"; });

/// Vertices inside if the lattice's coarsest level is solved alone.
size_t inside_on_coarsest_level(const ReconstructReport& report, const PointCloud& cloud) {
  const Lattice lattice{report.grid, {}};
  const Problem problem = make_problem(cloud, lattice);
  const Context one_thread(1);
  const auto fields = coarser_fields(problem.support, lattice, lattice.levels, one_thread);
  const SupportField& data = fields.back();
  const LevelBox box = lattice.box(lattice.levels - 1);
  const double lambda = report.certificate.lambda * std::pow(4, box.level);
  Level level =
      make_level(box, static_cast<float>(lambda), BrickMask::whole(box.bricks), data.grid, data.f, one_thread);
  solve_primal_dual(level, {}, one_thread);
  return count_inside(dense_labels(level));
}

TEST(Plate, OfThreeVoxelsStaysWholeThoughCoarseLevelsLoseIt) {
  constexpr double voxel = 1.0 / 190;  // its field fits between the layers of the coarsest grid
  const auto plate = make_plate({.thickness = 3 * voxel});
  const PointCloud cloud = sampled(*plate, 190 + 12, 1);
  const Reconstruction result = reconstructed(cloud, voxel);
  const TopologyReport topology = check_topology(result.mesh);
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 0);
  const double volume = plate->tessellate(1e-4).volume();
  EXPECT_NEAR(result.mesh.volume(), volume, 0.1 * volume);
  EXPECT_EQ(inside_on_coarsest_level(result.report, cloud), 0u) << "the coarsest level keeps the plate";
}

enum class Directions { radial, up };

class HalfSphere : public testing::TestWithParam<Directions> {};

/// Scanned from one side: the minimal surface closes the open side and stays away from the border. (With directions up
/// it is four voxels below the samples, with a small gain in energy: only a small gap shows that.)
TEST_P(HalfSphere, ClosesAndTouchesNoBorderVertex) {
  PointCloud cloud = sampled("sphere", 64, 2);
  keep_where(cloud, [](Vec3d p) { return p.z > 0; });
  if (GetParam() == Directions::up)
    for (Vec3f& n : cloud.normals) n = {0, 0, 1};
  const Reconstruction result = reconstructed(cloud, 1.0 / 52, 1e-5, RelaxParams().split_tolerance, Border::air);
  const TopologyReport topology = check_topology(result.mesh);
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 0);

  // No inside vertex has a neighbor in the fixed layer.
  const Lattice lattice{result.report.grid, {}};
  const LevelBox box = lattice.box(0);
  for (const Vec3d& v : result.mesh.vertices) {
    const Vec3d p = lattice.to_lattice(v);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_GT(p[axis], box.free_lo[axis]);
      ASSERT_LT(p[axis], box.free_hi[axis]);
    }
  }
  const double half_ball = std::numbers::pi / 12;
  EXPECT_GT(result.mesh.volume(), 0.8 * half_ball);
  EXPECT_LT(result.mesh.volume(), 1.3 * half_ball);
}

INSTANTIATE_TEST_SUITE_P(Views, HalfSphere, testing::Values(Directions::radial, Directions::up),
                         [](const auto& d) { return d.param == Directions::up ? "up" : "radial"; });

/// More distance to the border changes nothing: more padding, the same optimum.
TEST(Border, IsFarEnoughSlow) {
  PointCloud cloud = sampled("sphere", 64, 2);
  keep_where(cloud, [](Vec3d p) { return p.z > 0; });
  double energy[2];
  for (const int padding : {6, 13}) {
    const Problem problem = make_problem(cloud, place_lattice(cloud.box(), 1.0 / 52, padding));
    const PyramidSolution solution = solve(problem, 0.04, 1e-6);
    energy[padding == 13] = evaluate_energy(solution.finest, {}, Context(1)).primal;
  }
  EXPECT_NEAR(energy[0], energy[1], 2e-6 * std::abs(energy[0]));
}

/// Offsets of 5e6 with detail of 1e-3: the mesh is the same, translated.
TEST(Georeferenced, CoordinatesLoseNothing) {
  PointCloud near = sampled("knot", 64, 1);
  for (Vec3d& p : near.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] * 0x1p20) * 0x1p-20;
  const Vec3d offset{5e6, -4e6, 3e6};
  const PointCloud far = transformed(
      near, [&](Vec3d p) { return p + offset; }, [](Vec3f n) { return n; });
  const Reconstruction a = reconstructed(near, 0x1p-6), b = reconstructed(far, 0x1p-6);
  ASSERT_EQ(a.mesh.triangles, b.mesh.triangles);
  for (size_t i = 0; i < a.mesh.vertices.size(); ++i)
    ASSERT_LT(norm(b.mesh.vertices[i] - offset - a.mesh.vertices[i]), 2e-9);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
