#include "soapfilm/finish/hole_list.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "soapfilm/core/vec.h"
#include "soapfilm/finish/measure_result.h"
#include "support/flat_sheet.h"

namespace soapfilm {
namespace TEST_FILE {

using test::flat_sheet;

std::vector<uint8_t> where(const Mesh& mesh, const std::function<bool(Vec3d)>& is) {
  std::vector<uint8_t> flags;
  for (const Vec3d& v : mesh.vertices) flags.push_back(is(v));
  return flags;
}

bool near(Vec3d v, double x, double y, double radius) { return std::hypot(v.x - x, v.y - y) < radius; }

TEST(HoleList, SaysWhereAndHowLargeTheLargestFirst) {
  const Mesh mesh = flat_sheet(200, {1000, 0, 5}, 0.1);  // 20 x 20
  const auto unseen = where(mesh, [](Vec3d v) { return near(v, 1005, 6, 1.5) || near(v, 1014, 12, 3); });
  const std::vector<HoleFacts> holes = list_holes(mesh, unseen, {});
  ASSERT_EQ(holes.size(), 2u);
  EXPECT_NEAR(holes[0].area, 3.14159 * 9, 0.5);
  EXPECT_NEAR(holes[1].area, 3.14159 * 2.25, 0.3);
  EXPECT_NEAR(norm(holes[0].center - Vec3d{1014, 12, 5}), 0, 0.02);
  EXPECT_NEAR(norm(holes[1].center - Vec3d{1005, 6, 5}), 0, 0.02);
  EXPECT_NEAR(holes[0].diameter, 6.1, 0.2);
  EXPECT_NEAR(holes[1].diameter, 3.1, 0.2);
  EXPECT_FALSE(holes[0].cut || holes[1].cut);
}

TEST(HoleList, OneThatIsCutSaysSo) {
  const Mesh mesh = flat_sheet(50, {}, 0.1);
  const auto unseen = where(mesh, [](Vec3d v) { return near(v, 1, 1, 0.4) || near(v, 3, 3, 0.8); });
  const std::vector<HoleFacts> holes =
      list_holes(mesh, unseen, where(mesh, [](Vec3d v) { return near(v, 1, 1, 0.4); }));
  ASSERT_EQ(holes.size(), 2u);
  EXPECT_FALSE(holes[0].cut);
  EXPECT_TRUE(holes[1].cut);
}

TEST(HoleList, WhatReachesTheBorderIsNone) {
  const Mesh mesh = flat_sheet(50, {}, 0.1);
  EXPECT_TRUE(list_holes(mesh, where(mesh, [](Vec3d v) { return v.x < 1; }), {}).empty());
  EXPECT_TRUE(list_holes(mesh, where(mesh, [](Vec3d) { return false; }), {}).empty());
}

/// A box of bricks, its faces fine enough, and samples on all but the middle of the lid.
class MeasureResult : public testing::Test {
 protected:
  MeasureResult() {
    lattice.size = {60, 60, 60};
    lattice.voxel = 0.5;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true}) add_face(axis, high);
    PointCloud cloud;
    for (const Vec3d& v : mesh.vertices)
      if (!(v.z > 19.9 && near(v, 10, 10, 5))) cloud.positions.push_back(v);
    cloud.normals.assign(cloud.size(), {0, 0, 1});
    samples = sort_samples(cloud, cloud.normals, lattice, Context(1));
  }

  void add_face(int axis, bool high) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    Mesh face = flat_sheet(n, {}, 20.0 / n);
    for (Vec3d& v : face.vertices) {
      Vec3d p;
      p[(axis + 1) % 3] = v.x, p[(axis + 2) % 3] = v.y, p[axis] = high ? 20 : 0;
      v = p;
    }
    mesh.vertices.insert(mesh.vertices.end(), face.vertices.begin(), face.vertices.end());
    for (Triangle t : face.triangles) {
      if (!high) std::swap(t[1], t[2]);
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }

  static constexpr uint32_t n = 40;
  Lattice lattice;
  Mesh mesh;
  GridSamples samples;
};

TEST_F(MeasureResult, AreaIsSeenOrFilled) {
  const MeasureReport m = measure_result(mesh, samples, lattice, 1, {}, {}, Context(2));
  EXPECT_NEAR(m.area, 6 * 400, 1e-9);
  ASSERT_EQ(m.holes.size(), 1u);
  EXPECT_NEAR(m.holes[0].center.z, 20, 1e-9);
  EXPECT_EQ(m.filled_area, m.holes[0].area);
  // Farther than 1.5 from all samples of a hole of radius 5: 3.5.
  EXPECT_NEAR(m.filled_area, 3.14159 * 3.5 * 3.5, 4);
  EXPECT_FALSE(m.volume) << "its faces are not joined";
}

TEST_F(MeasureResult, TrimmedHolesCountAsItSays) {
  TrimReport trim;
  trim.holes = {{{}, 2, 7, false}, {{}, 1, 4, true}};
  const MeasureReport m = measure_result(mesh, samples, lattice, 1, trim, {}, Context(1));
  EXPECT_EQ(m.filled_area, 7);
  EXPECT_EQ(m.holes.size(), 2u);
}

TEST_F(MeasureResult, BothFillsOfAClosedMesh) {
  Mesh tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const auto of = [&](const Mesh& m, FillDifference fill) {
    return measure_result(m, samples, lattice, 1, {}, fill, Context(1));
  };
  const MeasureReport curved = of(tetrahedron, {false, 80});
  EXPECT_NEAR(*curved.volume, 36, 1e-12);
  EXPECT_EQ(curved.volume_smooth, curved.volume);
  EXPECT_NEAR(*curved.volume_flat, 36 - 80 * 0.125, 1e-12);
  const MeasureReport flat = of(tetrahedron, {true, 0});
  EXPECT_EQ(flat.volume_flat, flat.volume);
  EXPECT_FALSE(flat.volume_smooth);
  for (Triangle& t : tetrahedron.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(*of(tetrahedron, {false, 0}).volume, 36, 1e-12) << "a hollow holds as much";
}

}  // namespace TEST_FILE
}  // namespace soapfilm
