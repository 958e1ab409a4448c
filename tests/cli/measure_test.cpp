// soapfilm measure as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "measure/solids.h"
#include "soapfilm/io.h"
#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

class MeasureCommand : public testing::Test {
 protected:
  MeasureCommand() {
    write_mesh(box, box_mesh({0, 0, 0}, {2, 3, 4}));
    write_mesh(ground, relief(8, 4, [](double x, double) { return x - 1; }));
  }
  nlohmann::json facts(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "measure");
    arguments.insert(arguments.end(), {"--json", folder.file("m.json")});
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(read_file(folder.file("m.json")));
  }

  TemporaryFolder folder;
  std::string box = folder.file("box.ply"), ground = folder.file("ground.ply");
};

TEST_F(MeasureCommand, PrintsWhatItFindsWithItsUnit) {
  const ProcessResult result =
      run({"measure", box, "--unit", "m", "--voxel", "0.1", "--above", "z=1", "--section", "x=0.5", "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* words : {"closed, manifold, 1 component", "2 x 3 x 4 m", "52 m^2", "24 m^3", "+- 5.2 m^3 (21.7 %)",
                            "above z = 1", "18 m^3", "6 m^3", "section x = 0.5", "12 m^2, 1 contour, length 14 m"})
    EXPECT_TRUE(contains(result.out, words)) << words << " in\n" << result.out;
}

TEST_F(MeasureCommand, AnOpenMeshHasNoVolumeButOneAboveAPlane) {
  const ProcessResult result = run({"measure", ground, "--above", "z=0"});
  EXPECT_TRUE(contains(result.out, "none: the mesh is open (32 boundary edges); --above z=Z")) << result.out;
  EXPECT_TRUE(contains(result.out, "18, over an area of 12")) << result.out;
  const auto json = facts({ground, "--above", "0,0,0,0,0,2", "--within", "1,0,3,2"});
  EXPECT_TRUE(json["volume"].is_null());
  EXPECT_NEAR(json["at_plane"]["above"].get<double>(), 4, 1e-6);
  EXPECT_EQ(json["at_plane"]["plane"]["normal"], nlohmann::json({0, 0, 1}));
}

TEST_F(MeasureCommand, CutAndFillAndAboveAnotherMesh) {
  const std::string later = folder.file("later.ply");
  write_mesh(later, relief(8, 4, [](double x, double y) { return x - 1 + (y - 1); }));
  const auto since = facts({later, "--before", ground, "--cell", "0.01"})["since"];
  EXPECT_NEAR(since["fill"]["volume"].get<double>(), 0.5 * 3 * 3 * 4, 1e-2);
  EXPECT_NEAR(since["cut"]["volume"].get<double>(), 0.5 * 1 * 1 * 4, 1e-2);
  EXPECT_NEAR(since["net"]["volume"].get<double>(), 16, 1e-6);
  EXPECT_NEAR(since["footprint"].get<double>(), 16, 1e-6);
  const auto above = facts({box, "--above", ground})["above_mesh"];
  EXPECT_NEAR(above["fill"]["volume"].get<double>(), 24 - 0.5 * 3, 1e-2);
  EXPECT_TRUE(above["cut"].is_null());
}

TEST_F(MeasureCommand, WritesContours) {
  for (const char* name : {"c.svg", "c.dxf", "c.csv"}) {
    const auto json = facts({box, "--section", "z=1:3:1", "--section", "1,1,1,1,1,0", "--contours", folder.file(name)});
    ASSERT_EQ(json["sections"].size(), 4u);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(json["sections"][k]["area"].get<double>(), 6, 1e-6);
    EXPECT_NEAR(json["sections"][3]["area"].get<double>(), 4 * std::sqrt(8.0), 1e-6);
    EXPECT_GT(read_file(folder.file(name)).size(), 100u);
  }
}

TEST_F(MeasureCommand, ARoomIsWhatItsFacesLookInto) {
  write_mesh(folder.file("room.ply"), flipped(box_mesh({0, 0, 0}, {2, 3, 4})));
  const auto json = facts({folder.file("room.ply"), "--above", "z=3"});
  EXPECT_EQ(json["inside_out"], true);
  EXPECT_NEAR(json["volume"].get<double>(), 24, 1e-6);
  EXPECT_NEAR(json["at_plane"]["above"].get<double>(), 6, 1e-6);
}

TEST_F(MeasureCommand, RefusesInOneLine) {
  const struct {
    std::vector<std::string> arguments;
    const char* words;
  } cases[] = {
      {{"--above", "z="}, "above = z=, must be"},
      {{"--above", "1,2,3"}, "above = 1,2,3, must be"},
      {{"--above", "1,2,3,0,0,0"}, "normal must not be zero"},
      {{"--section", "z=1:0:1"}, "section = z=1:0:1, must be z=FROM:TO:STEP"},
      {{"--section", "z=0:1"}, "section = z=0:1, must be z=FROM:TO:STEP"},
      {{"--cell", "1"}, "--cell: only"},
      {{"--above", "z=0", "--cell", "1"}, "--cell: only"},
      {{"--within", "0,0,1,1"}, "--within: only"},
      {{"--above", "z=0", "--within", "0,0,0,1"}, "within = 0,0,0,1, must be"},
      {{"--above", "x=0", "--within", "0,0,1,1"}, "above = x=0, must be z=Z"},
      {{"--contours", "c.svg"}, "--contours: only --section"},
      {{"--section", "z=0", "--contours", "c.pdf"}, "must end in .svg, .dxf, .csv"},
      {{"--voxel", "0"}, "voxel = 0, must be > 0"},
      {{"--before", "none.ply"}, "none.ply"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> arguments{"measure", box};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << c.words;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(contains(result.err, c.words)) << result.err;
  }
  EXPECT_EQ(run({"measure", ground, "--before", box}).exit_code, 2);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
