// soapfilm evaluate as a user runs it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/io.h"
#include "support/program.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

/// A sphere of diameter 2.2 in a temporary folder.
class EvaluateCommand : public testing::Test {
 protected:
  EvaluateCommand() { write_mesh(mesh, make_sphere({.size = 2.2})->tessellate(1e-4)); }

  TemporaryFolder folder;
  std::string mesh = folder.file("mesh.ply");
};

TEST_F(EvaluateCommand, PrintsATable) {
  const ProcessResult result = run({"evaluate", mesh, "--truth", "sphere", "--size", "2", "--voxel", "0.05",
                                    "--f-score", "0.05,0.2", "--points", "5000", "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* words :
       {"truth to mesh", "mesh to truth", "in voxels", "normals, degrees", "F-score at 0.05      0.00 %",
        "F-score at 0.2       100.00 %", "closed, manifold, 1 component, genus 0", "0 pairs of triangles"})
    EXPECT_TRUE(contains(result.out, words)) << words << " in\n" << result.out;
}

TEST_F(EvaluateCommand, WritesJson) {
  write_points(folder.file("samples.ply"), sample_surface(*make_sphere({.size = 2.0}), 500, 1));
  const std::string json = folder.file("out.json");
  const ProcessResult result =
      run({"evaluate", mesh, "--truth", "sphere", "--size", "2", "--samples", folder.file("samples.ply"), "--voxel",
           "0.05", "--f-score", "0.2", "--points", "5000", "--json", json});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto facts = nlohmann::json::parse(read_file(json));
  EXPECT_EQ(facts["evaluation_version"], 1);
  EXPECT_EQ(facts["truth"]["shape"], "sphere");
  for (const char* direction : {"truth_to_mesh", "mesh_to_truth", "samples_to_mesh"}) {
    EXPECT_NEAR(facts[direction]["distance"]["mean"].get<double>(), 0.1, 1e-3) << direction;
    EXPECT_NEAR(facts[direction]["distance_voxels"]["maximum"].get<double>(), 2.0, 1e-2) << direction;
  }
  EXPECT_EQ(facts["samples_to_mesh"]["points"], 500);
  EXPECT_LT(facts["mesh_to_truth"]["normal_angle_deg"]["percentile95"].get<double>(), 3.0);
  EXPECT_EQ(facts["f_scores"][0]["f_score"], 1.0);
  EXPECT_NEAR(facts["volume"]["relative_error"].get<double>(), 0.331, 1e-3);
  EXPECT_EQ(facts["topology"]["mesh"]["genus"], 0);
  EXPECT_EQ(facts["topology"]["truth"]["components"], 1);
  EXPECT_EQ(facts["self_intersections"], 0);
}

TEST_F(EvaluateCommand, WithoutVoxelAndSamplesTheirKeysAreNull) {
  const std::string json = folder.file("out.json");
  ASSERT_EQ(run({"evaluate", mesh, "--truth", mesh, "--points", "1000", "--json", json}).exit_code, 0);
  const auto facts = nlohmann::json::parse(read_file(json));
  EXPECT_TRUE(facts["voxel"].is_null());
  EXPECT_TRUE(facts["samples_to_mesh"].is_null());
  EXPECT_TRUE(facts["truth_to_mesh"]["distance_voxels"].is_null());
  EXPECT_LT(facts["truth_to_mesh"]["distance"]["maximum"].get<double>(), 1e-12);
}

TEST_F(EvaluateCommand, WritesAPlyThatRenderColors) {
  const std::string ply = folder.file("error.ply");
  ASSERT_EQ(run({"evaluate", mesh, "--truth", "sphere", "--size", "2", "--points", "1000", "--error-ply", ply,
                 "--error-range", "0.2"})
                .exit_code,
            0);
  const Mesh errors = read_mesh(ply);
  ASSERT_EQ(errors.attributes.size(), 1u);
  EXPECT_EQ(errors.attributes[0].name, "distance");
  for (const float d : errors.attributes[0].values) ASSERT_NEAR(d, 0.1f, 1e-4f);
  EXPECT_EQ(errors.colors.size(), errors.vertices.size());
  EXPECT_EQ(run({"render", ply, "-o", folder.file("p.png"), "--color-by", "distance", "--size", "50x50"}).exit_code, 0);
}

TEST_F(EvaluateCommand, TheSameBytesForAnyNumberOfThreads) {
  for (const char* threads : {"1", "3"})
    ASSERT_EQ(run({"evaluate", mesh, "--truth", "torus", "--points", "3000", "--threads", threads, "--json",
                   folder.file(threads), "--error-ply", folder.file(std::string(threads) + ".ply")})
                  .exit_code,
              0);
  EXPECT_EQ(read_file(folder.path() / "1"), read_file(folder.path() / "3"));
  EXPECT_EQ(read_file(folder.path() / "1.ply"), read_file(folder.path() / "3.ply"));
}

/// Two triangles in a plane that contains no axis.
Mesh tilted_sheet() {
  Mesh mesh;
  mesh.vertices = {{0.1, 0.2, 0.7}, {0.4, 1.1, 1.1}, {-0.4, 1.2, 1.65}, {-0.7, 0.3, 1.25}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST_F(EvaluateCommand, AnOpenTruthHasNoVolumeAndIsNotTurned) {
  Mesh open = tilted_sheet();
  const std::string truth = folder.file("open.ply"), json = folder.file("out.json");
  for (const bool reversed : {false, true}) {
    if (reversed)
      for (Triangle& t : open.triangles) std::swap(t[0], t[1]);
    write_mesh(truth, open);
    const ProcessResult result = run({"evaluate", truth, "--truth", truth, "--points", "100", "--json", json, "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_TRUE(contains(result.out, "none (open), true none (open)")) << result.out;
    const auto facts = nlohmann::json::parse(read_file(json));
    EXPECT_EQ(facts["truth"]["turned"], false);
    EXPECT_TRUE(facts["truth"]["volume"].is_null());
    EXPECT_TRUE(facts["volume"]["truth"].is_null());
    EXPECT_EQ(facts["mesh_to_truth"]["normal_angle_deg"]["maximum"], 0.0);
  }
}

TEST_F(EvaluateCommand, AClosedTruthThatIsInsideOutIsTurnedWithAWarning) {
  Mesh inside_out = read_mesh(mesh);
  for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
  const std::string truth = folder.file("inside_out.ply"), json = folder.file("out.json");
  write_mesh(truth, inside_out);
  const ProcessResult result = run({"evaluate", mesh, "--truth", truth, "--points", "100", "--json", json, "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "inside_out.ply: inside-out (negative volume), its faces are turned"));
  const auto facts = nlohmann::json::parse(read_file(json));
  EXPECT_EQ(facts["truth"]["turned"], true);
  EXPECT_GT(facts["truth"]["volume"].get<double>(), 0.0);
}

TEST_F(EvaluateCommand, WarnsOfSamplesThatAreNotFinite) {
  const std::string samples = folder.file("samples.xyz"), json = folder.file("out.json");
  std::ofstream(samples) << "1 0 0\nnan 0 0\n0 1 0\n0 0 inf\n0 0 1\n";
  const ProcessResult result =
      run({"evaluate", mesh, "--truth", mesh, "--samples", samples, "--points", "100", "--json", json, "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "soapfilm: warning: 2 of 5 samples dropped: not finite\n");
  EXPECT_EQ(nlohmann::json::parse(read_file(json))["samples_to_mesh"]["points"], 3);
}

TEST_F(EvaluateCommand, PassesOnWhatReadingTheSamplesWarnsOf) {
  write_points(folder.file("scan.ply"), sample_surface(*make_sphere(), 20, 1));
  const std::string set = folder.file("set.conf");
  std::ofstream(set) << "color 3\nbmesh scan.ply 0 0 0 0 0 0 1\n";
  const ProcessResult result = run({"evaluate", mesh, "--truth", mesh, "--samples", set, "--points", "100", "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "set.conf:1: keyword 'color' ignored")) << result.err;
}

TEST_F(EvaluateCommand, TrianglesWithoutAreaHaveNoAngle) {
  Mesh flat;  // a square, and above it a line that is closer to every point of the truth
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0.5, 0.875}, {0.25, 0.5, 0.875}, {1, 0.5, 0.875}};
  flat.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh truth = flat;
  for (Vec3d& v : truth.vertices) v.z = 1;
  flat.triangles.push_back({4, 5, 6});
  write_mesh(folder.file("flat.ply"), flat);
  write_mesh(folder.file("truth.ply"), truth);
  const std::string json = folder.file("out.json");
  const ProcessResult result = run({"evaluate", folder.file("flat.ply"), "--truth", folder.file("truth.ply"),
                                    "--points", "100", "--json", json, "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto facts = nlohmann::json::parse(read_file(json));
  EXPECT_TRUE(facts["truth_to_mesh"]["normal_angle_deg"].is_null());
  EXPECT_EQ(facts["truth_to_mesh"]["points"], 100);
  EXPECT_EQ(facts["mesh_to_truth"]["normal_angle_deg"]["points"], 100);
  EXPECT_TRUE(contains(result.out, "  truth to mesh      none: ")) << result.out;
}

TEST_F(EvaluateCommand, OptionsAreCheckedBeforeFilesAreRead) {
  const auto expect = [](std::vector<std::string> options, const std::string& what) {
    options.insert(options.begin(), {"evaluate", "/nowhere/mesh.ply", "--quiet"});
    expect_refused(options, what);
  };
  expect({"--truth", "/nowhere/truth.ply", "--f-score", "0.1,-1"}, "f_score = -1, must be > 0 and finite");
  expect({"--truth", "/nowhere/truth.ply", "--f-score", "nan"}, "f_score = nan, must be > 0 and finite");
  expect({"--truth", "/nowhere/truth.ply", "--f-score", "inf"}, "f_score = inf, must be > 0 and finite");
  expect({"--truth", "/nowhere/truth.ply", "--voxel", "-1"}, "voxel = -1, must be > 0 and finite");
  expect({"--truth", "sphere", "--size", "0"}, "size = 0, must be > 0");
  expect({"--truth", "cube"}, "truth = cube, must be one of");
  expect({"--truth", "/nowhere/truth.ply", "--size", "2"}, "--size: only built-in shapes have it");
}

/// Each causes one line and exit code 2, and leaves no output.
TEST_F(EvaluateCommand, BadFilesLeaveNothingBehind) {
  const std::string json = folder.file("out.json"), ply = folder.file("error.ply");
  const auto file = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder.file(name)) << text;
    return folder.file(name);
  };
  const auto expect = [&](const std::string& judged, const std::string& truth, const std::string& what,
                          std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"evaluate", judged, "--truth", truth, "--json", json, "--error-ply", ply, "--quiet"});
    expect_refused(more, what);
    EXPECT_FALSE(std::filesystem::exists(json)) << what;
    EXPECT_FALSE(std::filesystem::exists(ply)) << what;
  };
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face ";
  const std::string list = "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  const std::string bad[] = {folder.file("absent.ply"),
                             file("empty.ply", ""),
                             file("empty.obj", ""),
                             file("empty.stl", ""),
                             file("no_faces.ply", header + "0" + list),
                             file("no_faces.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
                             file("no_faces.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"),
                             file("short.ply", header + "2" + list + "3 0 1 2\n"),
                             file("index.ply", header + "1" + list + "3 0 1 3\n"),
                             file("nan.off", "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"),
                             file("huge.off", "OFF\n3 1 0\n0 0 0\n1e120 0 0\n0 1e120 0\n3 0 1 2\n"),
                             file("cloud.xyz", "0 0 0\n1 0 0\n"),
                             folder.path().string()};
  for (const std::string& path : bad) {
    const std::string name = std::filesystem::path(path).filename().string() + ":";
    expect(path, "sphere", name);
    expect(mesh, path, name);
  }
  for (const auto& [name, text] : {std::pair{"none.xyz", ""}, {"nan.xyz", "nan 0 0\n"}, {"words.xyz", "a b c\n"}})
    expect(mesh, "sphere", name, {"--samples", file(name, text)});
  expect(mesh, "sphere", "f_score = -0.1, must be > 0 and finite", {"--f-score", "-0.1"});
}

TEST_F(EvaluateCommand, RefusesInOneLine) {
  const auto expect = [&](std::vector<std::string> options, const std::string& what) {
    options.insert(options.begin(), {"evaluate", mesh, "--quiet"});
    expect_refused(options, what);
  };
  expect({}, "--truth");
  expect({"--truth", "cube"}, "truth = cube, must be one of sphere, torus");
  expect({"--truth", "missing.ply"}, "missing.ply");
  expect({"--truth", mesh, "--size", "2"}, "--size: only built-in shapes have it");
  expect({"--truth", "sphere", "--voxel", "0"}, "voxel = 0, must be > 0");
  expect({"--truth", "sphere", "--f-score", "-1"}, "f_score = -1, must be > 0");
  expect({"--truth", "sphere", "--f-score", "near"}, "near");
  expect({"--truth", "sphere", "--points", "0"}, "--points");
  expect({"--truth", "sphere", "--samples", "no.xyz"}, "no.xyz");
  expect({"--truth", "sphere", "--error-ply", "e.obj"}, "error_ply = e.obj, must end in .ply");
  expect({"--truth", "sphere", "--error-range", "1"}, "--error-range: only --error-ply has it");
  expect({"--truth", "sphere", "--json", "/nowhere/e.json"}, "/nowhere/e.json");
  expect({"--truth", "sphere", "--gap", "0.2"}, "--gap: shape sphere has none");
  expect({"--truth", "sphere", "--error-ply", mesh}, "is also an input");
  const std::string scan = folder.file("scan.ply"), set = folder.file("set.conf");
  write_points(scan, sample_surface(*make_sphere(), 20, 1));
  std::ofstream(set) << "bmesh scan.ply 0 0 0 0 0 0 1\n";
  expect({"--truth", "sphere", "--samples", set, "--error-ply", scan}, "scan.ply: is also an input");
  expect({"--truth", "sphere", "--error-ply", folder.file("e.ply"), "--json", folder.file("e.ply")},
         "e.ply: is named for two outputs");
  for (const double size : {0.0, 1e200}) {  // no area; one too large for a double
    Mesh odd;
    odd.vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    odd.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    WriteOptions exact;
    exact.coordinate_precision = 1e-9;
    write_mesh(folder.file("odd.ply"), odd, exact);
    expect_refused({"evaluate", folder.file("odd.ply"), "--truth", "sphere", "-q"}, "odd.ply: a mesh of area");
    expect({"--truth", folder.file("odd.ply")}, "odd.ply: a mesh of area");
  }
  expect_refused({"evaluate", "/nowhere/mesh.ply", "--truth", "sphere", "-q"}, "/nowhere/mesh.ply");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
