// soapfilm info: what it prints of a cloud and of a mesh, as a table and as JSON.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "soapfilm/io.h"
#include "support/process.h"

namespace soapfilm::test {
namespace TEST_FILE {

class Info : public testing::Test {
 protected:
  void SetUp() override {
    PointCloud cloud;
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 50; ++j) cloud.positions.push_back({0.5 * i, 0.5 * j, 2});
    cloud.normals.assign(cloud.size(), {0, 0, 1});
    cloud.scans.resize(1);
    cloud.scans[0].name = "left side";
    cloud.scans[0].end = cloud.size();
    cloud.scans[0].sensor = Vec3d{1, 2, 3};
    write_points(cloud_, cloud);
    std::ofstream(mesh_) << "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  }
  static ProcessResult info(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {SOAPFILM_PROGRAM, "info"});
    return run_process(arguments);
  }

  TemporaryFolder folder_;
  std::string cloud_ = folder_.file("cloud.ply");
  std::string mesh_ = folder_.file("mesh.off");
};

TEST_F(Info, PrintsATable) {
  const ProcessResult result = info({cloud_, mesh_});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* part :
       {"samples     2,000", "normals of 2,000 samples", "sensor position of 1 of 1 scans", "left side",
        "position  1.00  2.00  3.00", "triangles  4", "closed, manifold, 1 component, genus 0"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " in:\n" << result.out;
}

TEST_F(Info, OfAMeshTellsWhatIsNotRead) {
  const std::string path = folder_.file("mesh.stl");
  write_mesh(path, read_mesh(mesh_));
  std::ofstream(path, std::ios::app) << "more";
  EXPECT_NE(info({path}).out.find("4 bytes after the last triangle are not read"), std::string::npos);
}

TEST_F(Info, PrintsJson) {
  const ProcessResult result = info({"--json", cloud_, mesh_});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json facts = nlohmann::json::parse(result.out);
  ASSERT_EQ(facts.size(), 2u);
  EXPECT_EQ(facts[0]["kind"], "points");
  EXPECT_EQ(facts[0]["samples"], 2000);
  EXPECT_NEAR(facts[0]["spacing"].get<double>(), 0.5, 0.1);
  EXPECT_EQ(facts[0]["scans"][0]["sensor"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(facts[1]["kind"], "mesh");
  EXPECT_EQ(facts[1]["genus"], 0);
  EXPECT_NEAR(facts[1]["volume"].get<double>(), 1.0 / 6, 1e-12);
}

TEST_F(Info, AnOpenMeshHasNoVolume) {
  const std::string open = folder_.file("open.off");
  std::ofstream(open) << "OFF\n4 3 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n";
  const ProcessResult result = info({"--json", open});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json facts = nlohmann::json::parse(result.out);
  EXPECT_EQ(facts[0]["closed"], false);
  EXPECT_TRUE(facts[0]["volume"].is_null());
  EXPECT_EQ(info({open}).out.find("volume"), std::string::npos);
}

TEST_F(Info, RefusesWhatItCannotRead) {
  const ProcessResult result = info({folder_.file("none.ply")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("none.ply: cannot be opened: No such file"), std::string::npos) << result.err;
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
