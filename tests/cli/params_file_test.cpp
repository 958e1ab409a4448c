// soapfilm reconstruct --params: the parameters of an earlier run.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/reconstruct_runs.h"
#include "soapfilm/io.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

using nlohmann::json;

class ParamsFile : public ReconstructRuns {
 protected:
  ParamsFile() { write_points(cloud, sample_surface(*make_torus(), 3000, 1)); }

  std::string written(const std::string& text) const {
    const std::string file = folder.file("params.json");
    std::ofstream(file) << text;
    return file;
  }

  std::string cloud = folder.file("cloud.ply");
};

TEST_F(ParamsFile, AReportGivesItsMeshAgain) {
  const json first =
      reported({cloud, "--resolution", "40", "--lambda", "0.03", "--directions", "normals", "--outside", "air",
                "--smoothing", "3", "--holes", "flat", "--trim", "0.5", "--max-iterations", "300"});
  ASSERT_FALSE(first.is_null());
  const std::string mesh_bytes = read_file(mesh);
  for (const std::string& text : {first.dump(), first["parameters"].dump()}) {
    const json again = reported({cloud, "--params", written(text)});
    ASSERT_FALSE(again.is_null());
    EXPECT_EQ(again["parameters"], first["parameters"]);
    EXPECT_EQ(read_file(mesh), mesh_bytes);
  }
}

/// Before or after it.
TEST_F(ParamsFile, OptionsBesidesItApply) {
  const std::string file = written(R"({"place": {"resolution": 60}, "energy": {"lambda": 0.5},
                                       "surface": {"isovalue": 0.4, "refine": false}, "trim": {"on": true}})");
  const json run = reported({cloud, "--lambda", "auto", "--params", file, "--voxel", "0.04", "--refine", "on",
                             "--isovalue", "auto", "--trim", "off"});
  ASSERT_FALSE(run.is_null());
  const json& p = run["parameters"];
  EXPECT_EQ(p["place"]["voxel"], 0.04);
  EXPECT_TRUE(p["place"]["resolution"].is_null());
  EXPECT_TRUE(p["energy"]["lambda"].is_null());
  EXPECT_EQ(p["energy"]["cross_validate"], true);
  EXPECT_EQ(p["surface"]["refine"], true);
  EXPECT_TRUE(p["surface"]["isovalue"].is_null());
  EXPECT_EQ(p["trim"]["on"], false);
}

TEST_F(ParamsFile, WhatIsWrongIsNamedWithTheFile) {
  const auto refuses = [&](const std::string& text, const std::string& what) {
    const std::string file = written(text);
    refused({cloud, "--params", file}, file + ": " + what);
  };
  refuses("", "is empty");
  refuses(" ", "parameters: not JSON");
  refuses("{", "parameters: not JSON");
  refuses("[1]", "parameters: must be a JSON object");
  refuses(R"({"place": {"voxels": 1}})", "parameters: unknown key 'place.voxels'");
  refuses(R"({"parameters": {"place": {"voxel": -1}}})", "voxel = -1, must be > 0");
  refuses(R"({"orient": {"neighbors": 2}})", "neighbors = 2, must be in [3, 1000]");
  refuses(R"({"place": {"padding": "six"}})", "parameters: place.padding = \"six\"");
  refused({cloud, "--params", folder.file("none.json")},
          folder.file("none.json") + ": cannot be opened: No such file or directory");
  refused({cloud, "--params", folder.file(".")}, ": is a directory, must be a file");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
