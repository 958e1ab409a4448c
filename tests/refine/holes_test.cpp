#include "soapfilm/refine/holes/holes.h"

#include <gtest/gtest.h>

#include "refine/band_support.h"
#include "soapfilm/mesh/topology.h"
#include "support/hash.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Samples of a shape without those for which `gone` is true, solved and refined.
template <class Gone>
Solved with_hole(const std::string& shape, int resolution, Gone&& gone) {
  Solved solved(shape, resolution);
  PointCloud cloud = disturbed(*solved.truth, resolution, 1, {});
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) keep[i] = !gone(cloud.positions[i]);
  cloud.filter(keep);
  solved.problem = make_problem(cloud, solved.problem.lattice);
  solved.solution = solve(solved.problem, 0.02, 1e-3);
  return solved;
}

Refined filled(const Solved& solved, HoleFill holes, int threads = 1) {
  RefineSetup params;
  params.holes = holes;
  return refined(solved, params, threads);
}

/// A cap of a tenth of the sphere, in a direction that is no axis.
bool in_cap(Vec3d p) { return dot(p, normalized(Vec3d{1, 2, 3})) > 0.4; }

TEST(Holes, ACapOfASphereBendsAsTheSphere) {
  const Solved solved = with_hole("sphere", 60, in_cap);
  const Refined flat = filled(solved, HoleFill::flat), smooth = filled(solved, HoleFill::smooth);
  EXPECT_EQ(smooth.report.holes.curved, 1u);
  EXPECT_LT(mean_error_vox(solved, smooth.mesh), 0.3 * mean_error_vox(solved, flat.mesh));
  const TopologyReport topology = check_topology(smooth.mesh);
  EXPECT_TRUE(topology.watertight());
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 0);
}

TEST(Holes, NothingChangesWhereThereIsNone) {
  const Solved solved("torus", 50);
  const Refined smooth = filled(solved, HoleFill::smooth);
  EXPECT_EQ(smooth.report.holes.curved, 0u);
  EXPECT_EQ(hash_mesh(smooth.mesh), hash_mesh(filled(solved, HoleFill::flat).mesh));
}

TEST(Holes, AnUnseenBaseStaysFlat) {
  // The lower third: the sides meet the minimal surface at about 70 degrees.
  const Solved solved = with_hole("sphere", 50, [](Vec3d p) { return p.z < -0.1; });
  const Refined smooth = filled(solved, HoleFill::smooth);
  EXPECT_EQ(smooth.report.holes.curved, 0u);
  EXPECT_EQ(smooth.report.holes.left, 1u);
  EXPECT_EQ(hash_mesh(smooth.mesh), hash_mesh(filled(solved, HoleFill::flat).mesh));
}

TEST(Holes, WhatIsAFifthOfTheSurfaceIsNoHole) {
  // Samples of the upper third only, rotated so that the minimal surface lies along no face of their box.
  const Solved solved = with_hole("sphere", 50, [](Vec3d p) { return dot(p, normalized(Vec3d{1, 2, 3})) > -0.15; });
  const Refined smooth = filled(solved, HoleFill::smooth);
  EXPECT_EQ(smooth.report.holes.curved, 0u);
  EXPECT_EQ(smooth.report.holes.left, 1u);
  EXPECT_EQ(hash_mesh(smooth.mesh), hash_mesh(filled(solved, HoleFill::flat).mesh));
}

/// Largest x of the sphere without a cap, over its radius, in a box that ends 3 voxels beyond the samples. The cap's
/// pole is 27 degrees off that axis, its boundary 53 degrees around: samples end at 0.9 radii, 4 voxels below.
double reach_along_x(bool open, size_t& bent) {
  constexpr int resolution = 100;
  Solved solved("sphere", 30);
  const double voxel = voxel_of_resolution(solved.truth->box(), resolution, 6);
  PointCloud cloud = disturbed(*solved.truth, resolution, 1, {});
  const Vec3d pole = normalized(Vec3d{1, 0, 0.52});
  std::vector<bool> keep(cloud.size());
  Box3d box;
  for (size_t i = 0; i < cloud.size(); ++i)
    if ((keep[i] = dot(cloud.positions[i], pole) < 0.3)) box.extend(cloud.positions[i]);
  cloud.filter(keep);
  solved.problem = make_problem(cloud, place_lattice(box, voxel, 3));
  solved.solution = solve(solved.problem, 0.02, 1e-3);
  RefineSetup params;
  params.open = open;
  const Refined result = refined(solved, params);
  EXPECT_TRUE(check_topology(result.mesh).watertight());
  bent = result.report.holes.curved;
  double most = 0;
  for (const Vec3d v : result.mesh.vertices) most = std::max(most, v.x);
  return most / 0.5;
}

TEST(Holes, ABulgeHasRoomBeyondTheSolvesBorder) {
  size_t bent = 0;
  EXPECT_NEAR(reach_along_x(false, bent), 1, 0.02);
  EXPECT_EQ(bent, 1u);
}

TEST(Holes, ABulgeStaysWithinAnOpenBox) {
  size_t bent = 0;
  EXPECT_LT(reach_along_x(true, bent), 0.97);
}

TEST(Holes, ThreadsDoNotMatter) {
  const Solved solved = with_hole("sphere", sanitized ? 32 : 50, in_cap);
  EXPECT_EQ(hash_mesh(filled(solved, HoleFill::smooth, 1).mesh), hash_mesh(filled(solved, HoleFill::smooth, 3).mesh));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
