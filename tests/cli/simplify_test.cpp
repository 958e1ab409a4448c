// soapfilm simplify, and reconstruct --simplify: what they write, say and refuse.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "soapfilm/io.h"
#include "support/process.h"
#include "support/program.h"
#include "tools/mesh/distance.h"
#include "tools/mesh/self_intersection.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

double farthest(const Mesh& from, const Mesh& to) {
  return point_to_mesh_distance(from.vertices, to, Context(1)).maximum;
}

/// Samples of the bracket, of genus 2, and the mesh of them.
class SimplifyCommand : public testing::Test {
 protected:
  SimplifyCommand() { write_points(samples, sample_surface(*make_part(), 8000, 1)); }

  std::vector<std::string> reconstruct(const std::string& mesh, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"-q", "reconstruct", samples, "-o", mesh, "--resolution", "48"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  TemporaryFolder folder;
  std::string samples = folder.file("samples.ply"), full = folder.file("full.ply");
};

TEST_F(SimplifyCommand, WritesFewerTrianglesWithinTheToleranceInEveryFormat) {
  ASSERT_EQ(run(reconstruct(full)).exit_code, 0);
  const Mesh before = read_mesh(full);
  ASSERT_EQ(check_topology(before).genus(), 2);
  for (const std::string extension : {"ply", "obj", "off", "stl", "glb"}) {
    const std::string small = folder.file("small." + extension);
    const ProcessResult result = run({"simplify", full, "-o", small, "--tolerance", "0.003"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(contains(result.err, "each mesh proved within 0.003 of the other")) << result.err;
    const Mesh after = read_mesh(small);
    EXPECT_LT(after.triangles.size(), before.triangles.size() / 5) << extension;
    EXPECT_TRUE(check_topology(after).watertight()) << extension;
    EXPECT_EQ(check_topology(after).genus(), check_topology(before).genus()) << extension;
    EXPECT_EQ(count_self_intersections(after, Context(1)), 0u) << extension;
    EXPECT_LE(farthest(before, after), 0.003) << extension;
    EXPECT_LE(farthest(after, before), 0.003) << extension;
  }
  const std::string few = folder.file("few.ply");
  ASSERT_EQ(run({"-q", "simplify", full, "-o", few, "--triangles", "1000"}).exit_code, 0);
  EXPECT_LE(read_mesh(few).triangles.size(), 1000u);
}

TEST_F(SimplifyCommand, IsAStageOfReconstruct) {
  const auto report_of = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words = reconstruct(folder.file("m.ply"), {"--report", folder.file("m.json")});
    words.insert(words.end(), options.begin(), options.end());
    const ProcessResult result = run(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::ifstream file(folder.file("m.json"));
    return nlohmann::json::parse(file);
  };
  EXPECT_TRUE(report_of({})["surface"]["simplify"].is_null());
  const auto report = report_of({"--simplify", "0.1vox", "--check"});
  const auto& simplify = report["surface"]["simplify"];
  EXPECT_EQ(simplify["triangles"], report["mesh"]["triangles"]);
  EXPECT_LT(simplify["triangles"].get<double>(), 0.25 * simplify["triangles_before"].get<double>());
  EXPECT_DOUBLE_EQ(simplify["tolerance"].get<double>(), 0.1 * report["grid"]["voxel"].get<double>());
  EXPECT_LE(simplify["proved_distance"].get<double>(), simplify["tolerance"].get<double>());
  EXPECT_TRUE(report["mesh"]["closed"].get<bool>() && report["mesh"]["manifold"].get<bool>());
  EXPECT_EQ(report["mesh"]["genus"], 2);
  EXPECT_TRUE(report["parameters"]["simplify"]["tolerance"].is_null());
  EXPECT_LE(report_of({"--triangles", "1000"})["mesh"]["triangles"], 1000);
  EXPECT_GE(report_of({"--simplify", "auto"})["surface"]["simplify"]["tolerance"].get<double>(),
            0.02 * report["grid"]["voxel"].get<double>() * (1 - 1e-12));
}

TEST_F(SimplifyCommand, WritesCoarserLevelsBesideIt) {
  const std::string out = folder.file("lod.ply");
  ASSERT_EQ(run(reconstruct(full)).exit_code, 0);
  const ProcessResult result = run({"simplify", full, "-o", out, "--tolerance", "0.001", "--lod", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "lod.2.ply: ")) << result.err;
  EXPECT_TRUE(contains(result.err, "proved within 0.007 of the full mesh")) << result.err;
  size_t triangles = read_mesh(full).triangles.size();
  double bound = 0, step = 0.001;
  for (const std::string name : {"lod.ply", "lod.1.ply", "lod.2.ply"}) {
    const Mesh level = read_mesh(folder.file(name));
    EXPECT_LT(level.triangles.size(), triangles);
    triangles = level.triangles.size();
    bound += step;
    step *= 2;
    EXPECT_LE(farthest(read_mesh(full), level), bound);
    EXPECT_TRUE(check_topology(level).watertight());
  }
  EXPECT_FALSE(std::filesystem::exists(folder.file("lod.3.ply")));

  const std::string glb = folder.file("lod.glb"), again = folder.file("again.glb");
  ASSERT_EQ(run({"-q", "simplify", full, "-o", glb, "--tolerance", "0.001", "--lod", "2", "--threads", "1"}).exit_code,
            0);
  ASSERT_EQ(
      run({"-q", "simplify", full, "-o", again, "--tolerance", "0.001", "--lod", "2", "--threads", "4"}).exit_code, 0);
  EXPECT_EQ(read_file(glb), read_file(again));
  EXPECT_EQ(read_mesh(glb).triangles, read_mesh(out).triangles);

  const auto levels_of = [&](const std::string& mesh) {
    const std::string report = folder.file("r.json");
    EXPECT_EQ(run(reconstruct(folder.file(mesh), {"--simplify", "0.001", "--lod", "2", "--report", report})).exit_code,
              0);
    return nlohmann::json::parse(read_file(report))["mesh"]["levels"];
  };
  const auto levels = levels_of("r.ply");
  ASSERT_EQ(levels.size(), 3U);
  bound = 0, step = 0.001;
  const std::vector<std::string> names{"r.ply", "r.1.ply", "r.2.ply"};
  for (size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(levels[i]["file"], folder.file(names[i]));
    const Mesh level = read_mesh(folder.file(names[i]));
    EXPECT_EQ(levels[i]["triangles"], level.triangles.size());
    if (i > 0) {
      EXPECT_LT(levels[i]["triangles"], levels[i - 1]["triangles"]);
    }
    bound += step;
    step *= 2;
    const auto proved = levels[i]["proved_distance"].get<double>();
    EXPECT_LE(proved, bound * (1 + 1e-12));
    EXPECT_LE(farthest(read_mesh(full), level), proved + 1e-6);  // a file rounds the full mesh
  }
  const auto nodes = levels_of("r.glb");
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_EQ(nodes[2]["file"], folder.file("r.glb"));
  EXPECT_EQ(nodes[2]["node"], "lod2");
  EXPECT_EQ(nodes[2]["triangles"], levels[2]["triangles"]);
  EXPECT_EQ(nodes[2]["proved_distance"], levels[2]["proved_distance"]);
  expect_refused(reconstruct(folder.file("s.ply"), {"--lod", "1"}), "--simplify auto makes it");
  expect_refused(reconstruct("-", {"--format", "ply", "--simplify", "auto", "--lod", "1"}),
                 "cannot go to standard output");
}

TEST_F(SimplifyCommand, RefusesWhatItCannotDo) {
  const std::string fan = folder.file("fan.obj");
  std::ofstream(fan) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n";
  expect_refused({"-q", "simplify", fan, "-o", folder.file("s.ply"), "--tolerance", "0.1"},
                 "edge 0-1 is in 3 triangles, must be a 2-manifold");
  expect_refused({"-q", "simplify", fan, "-o", folder.file("s.ply")},
                 "one of --tolerance and --triangles must be given");
  expect_refused({"-q", "simplify", fan, "-o", folder.file("s.ply"), "--tolerance", "x"}, "tolerance = x");
  expect_refused({"-q", "simplify", fan, "-o", fan, "--tolerance", "0.1"}, "fan.obj");
  for (const std::string lod : {"0", "-1", "17"})
    expect_refused({"-q", "simplify", fan, "-o", folder.file("s.ply"), "--tolerance", "0.1", "--lod", lod},
                   "lod = " + lod + ", must be in [1, 16]");
  expect_refused({"-q", "simplify", fan, "-o", folder.file("s.ply"), "--tolerance", "0.1", "--lod", "x"}, "--lod = x");
  const std::string second = folder.file("s.2.obj");
  std::filesystem::copy(fan, second);
  expect_refused({"-q", "simplify", second, "-o", folder.file("s.obj"), "--tolerance", "0.1", "--lod", "2"},
                 "s.2.obj: is also an input");
  expect_refused({"reconstruct", fan, "--simplify", "0vox"}, "simplify tolerance_vox = 0, must be > 0");
  expect_refused({"reconstruct", fan, "--simplify", "autovox"}, "simplify = autovox");
  expect_refused({"reconstruct", fan, "--simplify", "0.1", "--triangles", "5"}, "only one of them may be given");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
