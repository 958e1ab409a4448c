// A surveyor's first hour: a tile as a survey delivers it, LAZ with colors and a coordinate system, becomes a GLB with
// its .prj, face up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "io/laz_files.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

const std::string system_name = R"(PROJCS["ETRS89 / UTM zone 32N",UNIT["metre",1]])";

double height(double x, double y) { return 400 + 3 * std::sin(x / 9) + 2 * std::cos(y / 11); }

/// 60 m x 60 m, four points per square meter, green in the west and red in the east.
LasFile tile() {
  LasFile file;
  file.minor = 4;
  file.format = 7;
  file.records = {LasFile::record("LASF_Projection", 2112, system_name + '\0')};
  file.global_encoding = 1 << 4;
  Random random(3);
  for (int i = 0; i < 14400; ++i) {
    const double x = random.uniform(0, 60), y = random.uniform(0, 60);
    LasPoint point;
    const auto steps = [](double meters) { return static_cast<int32_t>(std::lround(1000 * meters)); };
    point.xyz = {steps(x), steps(y), steps(height(x, y) + 0.02 * random.normal())};
    const auto color = [](int part) { return static_cast<uint16_t>(257 * part); };
    point.rgb = x < 30 ? std::array{color(20), color(180), color(40)} : std::array{color(200), color(30), color(30)};
    file.points.push_back(point);
  }
  return file;
}

TEST(Surveyor, ATileWithColorsBecomesAGlbWithItsPrj) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("tiles"));
  std::ofstream(folder.file("tiles/tile_32_500_4649.laz"), std::ios::binary) << LazFile(tile().bytes(), {}).bytes();

  const ProcessResult facts = run({"info", "--json", folder.file("tiles")});
  ASSERT_EQ(facts.exit_code, 0) << facts.err;
  const auto cloud = nlohmann::json::parse(facts.out)[0];
  EXPECT_EQ(cloud["samples"], 14400);
  EXPECT_EQ(cloud["unit"], "metre");
  EXPECT_TRUE(cloud["colors"]);

  const ProcessResult made = run_in(folder.path(), {"reconstruct", "tiles", "-o", "tile.glb"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_TRUE(contains(made.err, "seen from above (+z), since they come from a survey's file")) << made.err;
  EXPECT_FALSE(contains(made.err, "warning")) << made.err;

  const ProcessResult parts =
      run_in(folder.path(), {"reconstruct", "-q", "tiles/*.laz", "-o", "p.glb", "--split", "9000"});
  ASSERT_EQ(parts.exit_code, 0) << parts.err;
  const auto index = nlohmann::json::parse(read_file(folder.file("p.parts.json")));
  EXPECT_EQ(index["coordinate_system"], system_name);
  EXPECT_EQ(index["unit"], "metre");
  EXPECT_NEAR(index["origin"][2].get<double>(), 400, 10);
  EXPECT_GE(index["parts"][0]["box"]["lo"][2].get<double>(), 390);
  EXPECT_TRUE(std::filesystem::exists(folder.file("p.prj")));
  EXPECT_EQ(read_file(folder.file("tile.prj")), system_name + "\n");

  const Mesh mesh = read_mesh(folder.file("tile.glb"));
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  size_t near = 0, right = 0, up = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double x = mesh.vertices[v].x - 500000, y = mesh.vertices[v].y - 4649000;
    near += std::abs(mesh.vertices[v].z - height(x, y)) < 0.25;
    right += (mesh.colors[v][0] > mesh.colors[v][1]) == (x > 30) || std::abs(x - 30) < 1;
  }
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]];
    up += cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a).z > 0;
  }
  const auto share = [](size_t part, size_t all) { return static_cast<double>(part) / static_cast<double>(all); };
  EXPECT_GT(share(near, mesh.vertices.size()), 0.98);
  EXPECT_GT(share(right, mesh.vertices.size()), 0.98);
  EXPECT_GT(share(up, mesh.triangles.size()), 0.98);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
