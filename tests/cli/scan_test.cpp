// soapfilm scan as a user runs it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "support/process.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

ProcessResult scan(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {SOAPFILM_PROGRAM, "scan"});
  return run_process(arguments);
}

TEST(Scan, WritesAScanSetAndTheTruth) {
  const TemporaryFolder folder;
  const std::string out = folder.file("deep/scans");
  const ProcessResult result = scan({"torus", "-o", out, "--size", "2", "--image", "60x50", "--views", "6"});
  ASSERT_EQ(result.exit_code, 0) << result.err;

  const auto shape = make_torus({.size = 2.0});
  const PointCloud cloud = read_points(out + "/scans.conf");
  EXPECT_EQ(cloud.scans.size(), 6u);
  for (const Vec3d& p : cloud.positions) ASSERT_LE(shape->distance(p), 2e-9);
  EXPECT_TRUE(cloud.normals.empty());

  const auto truth = nlohmann::json::parse(read_file(out + "/truth.json"));
  EXPECT_EQ(truth["object"]["shape"], "torus");
  EXPECT_EQ(truth["object"]["genus"], 1);
  EXPECT_EQ(truth["scans"]["samples"], cloud.size());
  EXPECT_EQ(truth["scanner"]["positions"].size(), 6u);
  const Mesh mesh = read_mesh(out + "/truth.ply");
  EXPECT_NEAR(mesh.volume(), truth["object"]["volume"].get<double>(), 1e-3 * mesh.volume());
}

TEST(Scan, ScansAMeshAndTurnsItWhenInsideOut) {
  const TemporaryFolder folder;
  Mesh mesh = make_part()->tessellate(1e-3);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  write_mesh(folder.file("inside-out.ply"), mesh);
  const std::string out = folder.file("scans");
  const ProcessResult result =
      scan({folder.file("inside-out.ply"), "-o", out, "--rays", "parallel", "--step", "2%", "--normals", "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("inside-out"), std::string::npos);
  EXPECT_GT(read_mesh(out + "/truth.ply").volume(), 0.0);
  const PointCloud cloud = read_points(out + "/scans.conf");
  ASSERT_EQ(cloud.normals.size(), cloud.size());
  for (const Scan& s : cloud.scans) {
    ASSERT_TRUE(s.view_direction);
    for (size_t i = s.begin; i < s.end; ++i)
      ASSERT_GT(dot(static_cast<Vec3d>(cloud.normals[i]), *s.view_direction), 0.0);
  }
}

/// One of the two orientations has a negative volume, because of the sheet's place in its box; neither has an inside.
TEST(Scan, AnOpenMeshIsScannedAsItIs) {
  const TemporaryFolder folder;
  Mesh open;
  open.vertices = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 2, 1}}) {
    open.triangles = {t};
    const std::string file = folder.file("open.ply"), out = folder.file("scans");
    write_mesh(file, open);
    const ProcessResult result = scan({file, "-o", out, "--samples", "50", "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(read_mesh(out + "/truth.ply").triangles, open.triangles);
    const auto object = nlohmann::json::parse(read_file(out + "/truth.json"))["object"];
    EXPECT_EQ(object["turned"], false);
    EXPECT_TRUE(object["volume"].is_null());
    EXPECT_GT(object["area"].get<double>(), 0.5);
  }
}

TEST(Scan, ASceneBringsItsScannerAndOptionsReplaceItPartByPart) {
  const TemporaryFolder folder;
  const std::string own = folder.file("own"), other = folder.file("other");
  ASSERT_EQ(scan({"room", "-o", own, "--image", "90x40", "--quiet"}).exit_code, 0);
  const auto scanner = nlohmann::json::parse(read_file(own + "/truth.json"))["scanner"];
  EXPECT_EQ(scanner["rays"], "spinning");
  EXPECT_EQ(scanner["positions"].size(), 2u);
  EXPECT_EQ(scanner["max_incidence_deg"], 89);
  EXPECT_EQ(scanner["elevations_deg"], (nlohmann::json{-88, 89}));
  const PointCloud cloud = read_points(own + "/scans.conf");
  EXPECT_EQ(cloud.scans[0].range_grid->columns, 90);
  EXPECT_EQ(cloud.scans[0].range_grid->rows, 40);

  ASSERT_EQ(scan({"room", "-o", other, "--rays", "central", "--position", "1,1,1.5", "--target", "5,3,0.5", "--image",
                  "64x48", "--max-range", "3", "--quiet"})
                .exit_code,
            0);
  const auto pinhole = nlohmann::json::parse(read_file(other + "/truth.json"))["scanner"];
  EXPECT_EQ(pinhole["rays"], "central");
  EXPECT_EQ(pinhole["positions"].size(), 1u);
  EXPECT_TRUE(pinhole["elevations_deg"].is_null());
  for (const Vec3d& p : read_points(other + "/scans.conf").positions) ASSERT_LE(norm(p - Vec3d{1, 1, 1.5}), 3 + 1e-9);
}

TEST(Scan, TheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  for (const char* threads : {"1", "3"}) {
    const auto out = folder.file(threads);
    ASSERT_EQ(scan({"torus", "-o", out, "--views", "2", "--image", "50x50", "--noise", "0.5%", "--outliers", "0.1",
                    "--drop-out", "0.1", "--misalignment", "1%", "--misalignment-angle", "1", "--threads", threads})
                  .exit_code,
              0);
  }
  for (const char* file : {"scan_000.ply", "scan_001.ply", "scans.conf", "truth.ply", "truth.json"})
    EXPECT_EQ(read_file(folder.path() / "1" / file), read_file(folder.path() / "3" / file)) << file;
}

TEST(Scan, RefusesInOneLineAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string out = folder.file("scans");
  const auto expect_refused = [&](std::vector<std::string> arguments, const std::string& what) {
    arguments.insert(arguments.end(), {"-o", out});
    const ProcessResult result = scan(arguments);
    EXPECT_EQ(result.exit_code, 2) << what;
    EXPECT_NE(result.err.find(what), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << what;
  };
  expect_refused({"cube"},
                 "object = cube, must be one of sphere, torus, part, plate, sheets, knot, arch, room, yard, street, "
                 "terrain, tunnel, facade, or a mesh file");
  expect_refused({"room", "--size", "2"}, "--size: only built-in shapes have it, room is a scene");
  expect_refused({"room", "--step", "0.1"}, "step: a spinning scanner has --image instead");
  expect_refused({"torus", "--rings", "10,0"}, "rings, span: only --rays spinning has them");
  expect_refused({"street", "--ghost-depth", "3,1"}, "ghost_hi = 1, must be >= ghost_lo");
  expect_refused({"missing.ply"}, "missing.ply");
  expect_refused({"part", "--noise", "loud"}, "noise = loud, must be a number >= 0, or one with a percent sign");
  expect_refused({"part", "--noise", "-1%"}, "noise = -0.01, must be >= 0");
  expect_refused({"part", "--image", "300"}, "image = 300, must be two whole numbers such as 300x300");
  expect_refused({"part", "--position", "1,2"}, "position = 1,2, must be three numbers X,Y,Z");
  expect_refused({"part", "--position", "0,0,9", "--target", "0,9,9"}, "no ray of 1 range images met the surface");
  expect_refused({"plate", "--thickness", "0.9"}, "thickness = 0.9, must be in [0.0001, 0.5] times the size");
  expect_refused({"part", "--views", "0"}, "views = 0, must be in [1, 10000]");
  expect_refused({"part", "--seed", "-1"}, "--seed = -1, must be a whole number from 0 to 9223372036854775807");
  expect_refused({"part", "--step", "0"}, "step = 0, must be > 0");
  expect_refused({"sphere", "--gap", "0.2"}, "--gap: shape sphere has none");
  expect_refused({"arch", "--thickness", "0.2"}, "--thickness: shape arch has none");
  expect_refused({"part", "--position", "5,0,0", "--views", "3"}, "--views: only an orbit has it, not --position");
  expect_refused({"part", "--elevations", "0,30"}, "elevations: only --orbit ring has them");
  expect_refused({"part", "--hole", "0.95"}, "hole = 0.95, must be in [0, 0.9]");
  expect_refused({"part", "--sparse-half", "0.2"}, "sparse_half = 0.2, must be >= 1");
  expect_refused({"part", "--samples", "0"}, "samples = 0, must be in [1, 1e9]");
  expect_refused({"part", "--samples", "many"}, "many");
  expect_refused({"part", "--samples", "9", "--outliers", "2"}, "outliers = 2, must be in [0, 1]");
  expect_refused({"part", "--samples", "9", "--image", "9x9"}, "--image: only scans have it, not --samples");
  expect_refused({"part", "--samples", "9", "--misalignment", "1%"}, "--misalignment: only scans have it");
  expect_refused({"part", "--samples", "9", "--views", "9"},
                 "--views: only scans, and --samples with --directions views, have it");
  expect_refused({"part", "--samples", "9", "--directions", "views", "--views", "0"}, "views = 0, must be in");
  expect_refused({"part", "--directions", "normals"}, "--directions: only --samples has it");
  expect_refused({"horse.ply", "--gap", "0.2"}, "--gap: only built-in shapes have it, horse.ply is a mesh");
}

TEST(Scan, RefusesAPlaceBeforeTheWork) {
  const TemporaryFolder folder;
  ASSERT_EQ(scan({"sphere", "-o", folder.file("a/b"), "--samples", "9"}).exit_code, 0);
  const std::string truth = folder.file("a/b/truth.ply"), before = read_file(truth);
  test::expect_refused({"scan", truth, "-o", folder.file("a/b")}, "truth.ply: is also an input");
  for (const char* name : {"samples.ply", "scan_000.ply"})
    std::filesystem::copy_file(truth, folder.file(name), std::filesystem::copy_options::overwrite_existing);
  test::expect_refused({"scan", folder.file("samples.ply"), "-o", folder.path().string(), "--samples", "9"},
                       "samples.ply: is also an input");
  test::expect_refused({"scan", folder.file("scan_000.ply"), "-o", folder.path().string()},
                       "scan_000.ply: is also an input");
  test::expect_refused({"scan", "sphere", "-o", truth + "/c"}, "cannot make the folder");
  std::filesystem::create_directory(folder.file("truth.json"));  // a path to which nothing is written
  EXPECT_EQ(scan({"sphere", "-o", folder.file("c"), "--samples", "9"}).exit_code, 0);
  EXPECT_EQ(read_file(truth), before);
}

TEST(Scan, WritesEvenSamplesInsteadOfScans) {
  const TemporaryFolder folder;
  const std::string out = folder.file("even");
  const ProcessResult result = scan({"torus", "-o", out, "--samples", "4000", "--noise", "1%", "--outliers", "0.1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const PointCloud cloud = read_points(out + "/samples.ply");
  EXPECT_EQ(cloud.size(), 4000u);
  EXPECT_EQ(cloud.normals.size(), 4000u);
  EXPECT_TRUE(cloud.sensors.empty());
  EXPECT_FALSE(std::filesystem::exists(out + "/scans.conf"));
  const auto truth = nlohmann::json::parse(read_file(out + "/truth.json"));
  EXPECT_EQ(truth["samples"]["file"], "samples.ply");
  EXPECT_EQ(truth["sampling"]["directions"], "normals");
  EXPECT_DOUBLE_EQ(truth["sampling"]["noise"].get<double>(), 0.01);

  const ProcessResult weak = scan(
      {"torus", "-o", folder.file("weak"), "--samples", "4000", "--directions", "views", "--views", "7", "--quiet"});
  ASSERT_EQ(weak.exit_code, 0) << weak.err;
  const PointCloud seen = read_points(folder.file("weak/samples.ply"));
  EXPECT_TRUE(seen.normals.empty());
  EXPECT_EQ(seen.sensors.size(), 4000u);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder.file("weak/truth.json")))["sampling"]["positions"].size(), 7u);
}

TEST(Scan, MissingSamplesAreCounted) {
  const TemporaryFolder folder;
  const auto samples_of = [&](const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", folder.file(name), "--quiet"});
    const ProcessResult result = scan(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(read_file(folder.file(name + "/truth.json")));
  };
  const std::vector<std::string> views{"arch", "--views", "5", "--image", "60x60"};
  std::vector<std::string> holed = views;
  holed.insert(holed.end(), {"--hole", "0.1", "--sparse-half", "50"});
  const size_t whole = samples_of("whole", views)["scans"]["samples"];
  const auto missing = samples_of("holed", holed);
  EXPECT_EQ(missing["scans"]["samples"].get<size_t>() + missing["missing"]["samples"].get<size_t>(), whole);
  EXPECT_LT(missing["scans"]["samples"].get<size_t>(), whole * 6 / 10);
  EXPECT_EQ(read_points(folder.file("holed/scans.conf")).size(), missing["scans"]["samples"].get<size_t>());
}

TEST(Scan, AFolderThatCannotBeMadeIsRefused) {
  const TemporaryFolder folder;
  write_text_file(folder.file("in_the_way"), "a file");
  const ProcessResult result = scan({"sphere", "-o", folder.file("in_the_way"), "--views", "1", "--image", "9x9"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("in_the_way: cannot make the folder"), std::string::npos) << result.err;
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
