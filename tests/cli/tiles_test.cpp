// soapfilm tiles: a folder of tiles that viewers of 3D Tiles read.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/georeference.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

using nlohmann::json;

class Tiles : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"scan", "torus", "-q", "-o", folder.file("in"), "--samples", "20000"}).exit_code, 0);
    ASSERT_EQ(run({"reconstruct", "-q", folder.file("in/samples.ply"), "-o", mesh, "--resolution", "64"}).exit_code, 0);
  }
  json tileset() const { return json::parse(read_file(out + "/tileset.json")); }

  TemporaryFolder folder;
  std::string mesh = folder.file("mesh.ply"), out = folder.file("tiles");
};

/// Boxes hold what is in them, errors fall, files are there: as the standard demands.
void check_tile(const json& tile, const std::string& folder, double error_above, size_t& count) {
  ++count;
  EXPECT_LE(tile["geometricError"], error_above);
  EXPECT_EQ(tile["refine"], "REPLACE");
  const json& box = tile["boundingVolume"]["box"];
  ASSERT_EQ(box.size(), 12u);
  const Mesh content = read_mesh(folder + "/" + tile["content"]["uri"].get<std::string>());
  EXPECT_GT(content.triangles.size(), 0u);
  for (const Vec3d& v : content.vertices)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LE(std::abs(v[axis] - box[static_cast<size_t>(axis)].get<double>()),
                box[static_cast<size_t>(3 + 4 * axis)].get<double>() + 1e-6);
  if (tile.contains("children"))
    for (const json& child : tile["children"]) check_tile(child, folder, tile["geometricError"], count);
}

TEST_F(Tiles, AreATilesetOfTheMesh) {
  const ProcessResult result = run({"tiles", mesh, "-o", out, "--triangles", "1000"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json set = tileset();
  EXPECT_EQ(set["asset"]["version"], "1.1");
  size_t count = 0;
  check_tile(set["root"], out, set["geometricError"], count);
  EXPECT_GT(count, 8u);
  size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(out + "/tiles")) files += file.is_regular_file();
  EXPECT_EQ(files, count);
  // Where the mesh was.
  const Box3d box = read_mesh(mesh).box();
  const json& place = set["root"]["transform"];
  for (size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(place[12 + axis], box.center()[static_cast<int>(axis)], 1e-9);
}

TEST_F(Tiles, StandOnTheGlobeWhereTheMeshDoes) {
  if (!cli::knows_earth()) GTEST_SKIP() << "built without PROJ";
  Mesh moved = read_mesh(mesh);
  for (Vec3d& v : moved.vertices)
    v = v + Vec3d{500000, 5400000, 300};  // on the central meridian of zone 32: 9 degrees east
  WriteOptions precise;
  precise.coordinate_precision = 1e-4;
  write_mesh(mesh, moved, precise);
  std::ofstream(folder.file("mesh.prj")) << "EPSG:25832\n";
  ASSERT_EQ(run({"tiles", "-q", mesh, "-o", out}).exit_code, 0);
  const json place = tileset()["root"]["transform"];
  const Vec3d p{place[12], place[13], place[14]};
  EXPECT_NEAR(std::atan2(p.y, p.x) * 180 / 3.14159265358979, 9, 1e-9);
  EXPECT_NEAR(std::hypot(p.x, p.y, p.z), 6366600, 2000);
  // Upright: the third column points away from the earth's middle, nearly; the first one east.
  const Vec3d up{place[8], place[9], place[10]}, east{place[0], place[1], place[2]};
  EXPECT_GT((up.x * p.x + up.y * p.y + up.z * p.z) / std::hypot(p.x, p.y, p.z), 0.9999);
  EXPECT_NEAR(east.x, -std::sin(9 * 3.14159265358979 / 180), 1e-9);
  EXPECT_NEAR(east.z, 0, 1e-12);
}

/// The same place by map, by degrees and from the earth's middle; feet are converted.
TEST(EarthFrame, IsTheSameByAnySystem) {
  if (!cli::knows_earth()) GTEST_SKIP() << "built without PROJ";
  const auto place_of = [](const std::string& system, Vec3d center) {
    std::vector<Vec3d> points{center + Vec3d{0, 0, 1}};
    const auto frame = cli::move_to_earth(system, center, points).to_earth;
    return std::pair(Vec3d{frame[12], frame[13], frame[14]}, points[0]);
  };
  const auto expect_near = [](Vec3d a, Vec3d b, double most) {
    EXPECT_NEAR(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), 0, most);
  };
  // On the central meridian of zone 32; by the ellipsoid's equation, and the meridian's arc by quadrature.
  const auto [degrees, above] = place_of("EPSG:4326", {9, 48, 300});
  expect_near(degrees, {4223274.890235705, 668901.0298266496, 4717099.273563049}, 1e-6);
  expect_near(above, {0, 0, 1}, 1e-6);
  const auto [map, above_map] = place_of("EPSG:25832", {500000, 5316300.224451379, 300});
  expect_near(map, degrees, 1e-3);
  expect_near(above_map, {0, 0, 1}, 1e-6);
  expect_near(place_of("EPSG:4978", degrees).first, degrees, 1e-6);
  const auto [feet, above_feet] = place_of("EPSG:2263", {987000, 211000, 0});  // New York, US survey feet
  EXPECT_NEAR(std::atan2(feet.y, feet.x) * 180 / 3.14159265358979, -73.98, 0.02);
  expect_near(above_feet, {0, 0, 1200.0 / 3937}, 1e-6);
}

TEST_F(Tiles, LeaveNothingBehindWhereTheyFail) {
  expect_refused({"tiles", "-q", mesh, "-o", out, "--coordinate-system", "EPSG:nonsense"}, "EPSG:nonsense");
  EXPECT_FALSE(std::filesystem::exists(out));
  std::ofstream(folder.file("far.obj")) << "v 100 200 0\nv 101 200 0\nv 100 201 0\nf 1 2 3\n";
  if (cli::knows_earth())
    expect_refused({"tiles", "-q", folder.file("far.obj"), "-o", out, "--coordinate-system", "EPSG:4326"},
                   "'EPSG:4326' does not hold the point 100.5, 200.5");
  EXPECT_FALSE(std::filesystem::exists(out));
  expect_refused({"tiles", "-q", mesh, "-o", out, "--triangles", "5"}, "must be >= 100");
  EXPECT_FALSE(std::filesystem::exists(out));
  std::filesystem::create_directory(out);
  std::ofstream(out + "/mine") << "mine";
  expect_refused({"tiles", "-q", mesh, "-o", out}, "must be empty");
  EXPECT_EQ(read_file(out + "/mine"), "mine");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
