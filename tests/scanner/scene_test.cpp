#include "tools/scanner/scene.h"

#include <gtest/gtest.h>

#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "tools/scanner/mesh_surface.h"

namespace soapfilm {
namespace TEST_FILE {

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, ShowsItsFacesToItsOwnScanner) {
  const Scene scene = make_scene(GetParam());
  EXPECT_EQ(scene.name, GetParam());
  ScannerParams params = scene.scanner;
  params.columns = 120;
  params.rows = 60;
  params.normals = true;
  const MeshSurface surface(scene.mesh, Context(1), Faces::as_given);
  const ScanSet set = virtual_scan(surface, params, Context(1));
  ASSERT_EQ(set.cloud.scans.size(), scene.scanner.positions.size());
  for (const Scan& scan : set.cloud.scans) {
    ASSERT_GT(scan.size(), 1000u);
    size_t away = 0;
    for (size_t i = scan.begin; i < scan.end; ++i) {
      const Vec3d towards = scan.sensor ? *scan.sensor - set.cloud.positions[i] : *scan.view_direction;
      away += dot(static_cast<Vec3d>(set.cloud.normals[i]), towards) < 0;
    }
    // A gable without its triangle shows the inside of a roof.
    EXPECT_LE(away, GetParam() == "terrain" ? scan.size() / 1000 : 0);
  }
}

TEST_P(EveryScene, HasNoTriangleTwiceOrWithoutArea) {
  const Scene scene = make_scene(GetParam());
  const TopologyReport topology = check_topology(scene.mesh);
  EXPECT_EQ(topology.degenerate_triangles, 0u);
  EXPECT_EQ(topology.zero_area_triangles, 0u);
  EXPECT_EQ(topology.duplicate_triangles, 0u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(scene_names()),
                         [](const auto& each) { return each.param; });

TEST(Scene, OfAnotherNameIsRefused) { EXPECT_THROW(make_scene("castle"), ParameterError); }

/// Of the room, but for what furniture hides, all that a closed room of this size has: both openings are left out.
TEST(Scene, TheRoomsWallsHaveADoorAndAWindow) {
  const Scene room = make_room();
  const double walls = 2 * (6 * 4 + 6 * 2.6 + 4 * 2.6) - 0.9 * 2.0 - 2.0 * 1.2;
  const double cabinet = 2 * 0.6 * 1.9 + 2 * 1.2 * 1.9 + 1.2 * 0.6, table = 2 * (1.6 * 0.8) + 2 * 0.06 * (1.6 + 0.8);
  const double legs = 4 * (4 * 0.08 * 0.70 + 0.08 * 0.08), lamp = 0.3 * 0.3 + 4 * 0.3 * 0.15;
  EXPECT_NEAR(room.mesh.area(), walls + cabinet + table + legs + lamp, 1e-9);
}

TEST(MeshSurface, ARoomKeepsItsFacesWhereTheyAreTakenAsGiven) {
  Mesh box;  // a closed one that looks inwards
  box.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  box.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  ASSERT_LT(box.volume(), 0);
  EXPECT_TRUE(MeshSurface(box, Context(1)).reversed());
  EXPECT_FALSE(MeshSurface(box, Context(1), Faces::as_given).reversed());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
