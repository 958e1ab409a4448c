// soapfilm reconstruct --method and its options: --norm, --lambda auto, --write-levels.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/reconstruct_runs.h"
#include "soapfilm/core/method.h"
#include "soapfilm/core/names.h"
#include "soapfilm/core/random.h"
#include "soapfilm/io.h"
#include "soapfilm/mesh/topology.h"
#include "support/sanitized.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm::test {
namespace TEST_FILE {

using nlohmann::json;

const std::string resolution = sanitized ? "32" : "44";

/// A folder with a sphere of diameter 1: as range scans, and as even samples.
class MethodCommand : public ReconstructRuns {
 protected:
  void SetUp() override {
    ScannerParams scanner;
    scanner.step = 0.03;
    scanner.views = 10;
    write_points(scans, virtual_scan(*make_sphere(), scanner, Context(1)).cloud);
    write_points(even, sample_surface(*make_sphere(), 3000, 1));
  }

  std::string scans = folder.file("scans.ply");
  std::string even = folder.file("even.ply");
};

TEST_F(MethodCommand, EveryNameRunsAndReports) {
  for (const std::string name : names_of<Method>) {
    const json report = reported({scans, "--method", name, "--resolution", "44"});
    ASSERT_FALSE(report.is_null()) << name;
    EXPECT_EQ(report["method"]["name"], name);
    EXPECT_EQ(report["parameters"]["solve"]["method"], name);
    EXPECT_EQ(report["mesh"]["closed"], true) << name;
    EXPECT_EQ(report["mesh"]["genus"], 0) << name;
    EXPECT_TRUE(contains(report["command"].get<std::string>(), "--method " + name));
    EXPECT_EQ(check_topology(read_mesh(mesh)).triangles, report["mesh"]["triangles"]);
  }
}

TEST_F(MethodCommand, SaysWhatIsProvedAndWhatIsNot) {
  const auto lines = [&](const std::string& method) {
    return run({"reconstruct", scans, "-o", mesh, "--resolution", resolution, "--method", method}).err;
  };
  EXPECT_TRUE(contains(lines("tv-sor"), "segmentation proved within")) << lines("tv-sor");
  EXPECT_TRUE(contains(lines("graph-cut-6"), "(method graph-cut-6 proves no bound of it)")) << lines("graph-cut-6");
  EXPECT_FALSE(contains(lines("vrip"), "lambda")) << lines("vrip");
  EXPECT_FALSE(contains(lines("poisson"), "lambda")) << lines("poisson");
}

TEST_F(MethodCommand, AnUnknownMethodIsRefused) {
  refused({scans, "--method", "magic"}, "magic");
  refused({scans, "--method", "magic"}, "graph-cut-26");
  refused({scans, "--norm", "round"}, "round");
}

TEST_F(MethodCommand, VripNamesTheScanThatIsNoRangeImage) {
  refused({even, "--method", "vrip"}, "vrip needs range scans: scan \"samples\" has no range grid");
}

TEST_F(MethodCommand, WhatAMethodDoesNotHaveIsRefused) {
  refused({scans, "--method", "poisson", "--lambda", "auto"}, "lambda = auto: the surface of method poisson");
  refused({scans, "--method", "tv-sor", "--norm", "anisotropic"}, "norm = anisotropic: method tv-sor has none");
  refused({scans, "--method", "poisson", "--gap"}, "gap = true: method poisson has no certificate");
  refused({scans, "--method", "vrip", "--isovalue", "0.4"}, "isovalue = 0.4: method vrip finds its own");
  refused({scans, "--method", "graph-cut-6", "--threshold", "0.3"}, "threshold = 0.3: method graph-cut-6 has none");
  refused({scans, "--method", "poisson", "--tolerance", "1e-6"}, "--tolerance: only method tv has it");
  refused({scans, "--method", "tv-sor", "--max-iterations", "9"}, "--max-iterations: only method tv has it");
  refused({scans, "--method", "graph-cut-6", "--link-weights", "cauchy-crofton"},
          "--link-weights: only method graph-cut-26 has it");
  refused({scans, "--front", "3"}, "--front: only method vrip has it");
  refused({scans, "--folds", "3"}, "--folds: only --lambda auto has it");
  refused({scans, "--method", "vrip", "--front", "0"}, "front = 0, must be > 0 and <= 1000");
}

TEST_F(MethodCommand, LinkWeightsAndNormReachTheCut) {
  const auto flow = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {scans, "--method", "graph-cut-26", "--resolution", resolution});
    return reported(arguments)["method"]["flow"].get<double>();
  };
  EXPECT_NE(flow({}), flow({"--link-weights", "cauchy-crofton"}));
  EXPECT_NE(flow({}), flow({"--norm", "anisotropic"}));
}

TEST_F(MethodCommand, AutomaticLambdaReportsItsCurve) {
  const json report = reported({even, "--lambda", "auto", "--folds", "3", "--resolution", resolution});
  ASSERT_FALSE(report.is_null());
  const json& select = report["cross_validation"];
  EXPECT_EQ(select["folds"], 3);
  EXPECT_EQ(select["whole_scans"], false);
  ASSERT_EQ(select["curve"].size(), report["parameters"]["cross_validation"]["candidates"].size());
  EXPECT_EQ(report["parameters"]["energy"]["cross_validate"], true);
  EXPECT_TRUE(report["parameters"]["energy"]["lambda"].is_null());
  const double chosen = select["chosen"];
  const auto point = std::find_if(select["curve"].begin(), select["curve"].end(),
                                  [&](const json& p) { return p["lambda_per_density"] == chosen; });
  ASSERT_NE(point, select["curve"].end()) << "one of the candidates";
  EXPECT_EQ((*point)["lambda"], report["certificate"]["lambda"]);
  const double density = report["input"]["samples_per_voxel2"];
  EXPECT_NEAR(report["certificate"]["lambda"].get<double>(), chosen * density, 1e-12);
  for (const json& p : select["curve"]) {
    EXPECT_GE(p["error"].get<double>(), 0);
    EXPECT_LE(p["error"].get<double>(), 1);
  }
}

TEST_F(MethodCommand, ALambdaThatIsNoNumberIsRefused) {
  refused({even, "--lambda", "abc"}, "lambda = abc, must be 'auto' or a number > 0");
  refused({even, "--lambda", "0.1x"}, "lambda = 0.1x, must be 'auto' or a number > 0");
  refused({even, "--lambda", "auto", "--folds", "1"}, "folds");
}

TEST_F(MethodCommand, WritesTheSurfaceOfEveryLevel) {
  const std::string levels = folder.file("deep/levels");
  const json report = reported({even, "--write-levels", levels, "--resolution", sanitized ? "56" : "72"});
  ASSERT_FALSE(report.is_null());
  const auto& solved = report["grid"]["levels"];
  const auto count = static_cast<size_t>(
      std::count_if(solved.begin(), solved.end(), [](const json& level) { return level["lambda_share"] == 1; }));
  ASSERT_GE(count, 3u);
  const Box3d box = read_mesh(mesh).box();
  size_t finer = SIZE_MAX;
  for (size_t level = 0; level < count; ++level) {
    const std::string file = levels + "/level_" + std::to_string(level) + ".ply";
    ASSERT_TRUE(std::filesystem::exists(file)) << file;
    const Mesh surface = read_mesh(file);
    EXPECT_TRUE(check_topology(surface).watertight()) << file;
    EXPECT_LT(surface.triangles.size(), finer) << "level 0 is the finest";
    finer = surface.triangles.size();
    // All vertices are near the mesh, within one of their cells and half a cell of rounding.
    const double cell = report["grid"]["voxel"].get<double>() * static_cast<double>(size_t{1} << level);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(surface.box().lo[axis], box.lo[axis], 1.5 * cell) << file;
      EXPECT_NEAR(surface.box().hi[axis], box.hi[axis], 1.5 * cell) << file;
      EXPECT_NEAR(surface.box().center()[axis], box.center()[axis], 0.6 * cell) << file;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(levels + "/level_" + std::to_string(count) + ".ply"));
}

/// A sphere whose samples are dense around one pole; elsewhere a share of them.
void write_uneven(const std::string& cloud, int samples, double share) {
  std::ofstream out(cloud);
  Random random(1);
  for (int n = 0; n < samples;) {
    const Vec3d p = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    if (p.z < 0.8 && random.uniform() > share) continue;
    out << p.x << ' ' << p.y << ' ' << p.z << ' ' << p.x << ' ' << p.y << ' ' << p.z << '\n';
    ++n;
  }
}

/// With the norm of the cut's own energy the two energies of all levels are one.
TEST_F(MethodCommand, GraphCutsHaveLevels) {
  const std::string cloud = folder.file("uneven.xyz");
  write_uneven(cloud, sanitized ? 2000 : 5000, 0.05);
  for (const std::string method : {"graph-cut-6", "graph-cut-26"}) {
    const json report = reported({cloud, "--method", method, "--norm", "anisotropic", "--adapt", "on"});
    ASSERT_FALSE(report.is_null()) << method;
    EXPECT_EQ(report["mesh"]["closed"], true) << method;
    EXPECT_EQ(report["mesh"]["genus"], 0) << method;
    EXPECT_GE(report["grid"]["leaves"].size(), 2u) << method;
    const json &leaves = report["method"]["leaves"], &certificate = report["certificate"];
    EXPECT_EQ(leaves["globally_optimal"], true) << method;
    EXPECT_GT(leaves["links"], leaves["vertices"]) << method;
    EXPECT_TRUE(certificate["dual"].is_null() && certificate["gap_where_levels_meet"].is_null()) << method;
    const double energy = leaves["energy"], evaluated = certificate["primal_binary"];
    EXPECT_LT(energy, 0) << method;
    if (method == "graph-cut-6") {
      EXPECT_NEAR(energy, evaluated, 1e-6 * std::abs(energy));
    }
  }
}

TEST_F(MethodCommand, MethodsOfTheWholeBoxHaveNoLevels) {
  for (const std::string method : {"tv-sor", "poisson", "vrip"})
    refused({scans, "--method", method, "--adapt", "on"},
            "adapt: method " + method + " has no levels, as it works on the whole box");
  refused({even, "--method", "graph-cut-6", "--adapt", "on", "--refine", "off"}, "adapt: needs refinement");
}

/// Where levels adapt a finer one has its surface where its places are, the same as the mesh's within its cells, and
/// ends there without walls.
TEST_F(MethodCommand, WritesTheSurfaceOfFinerLevels) {
  const std::string cloud = folder.file("uneven.xyz"), levels = folder.file("uneven");
  write_uneven(cloud, 20000, 0.03);
  const json report = reported({cloud, "--adapt", "on", "--write-levels", levels});
  ASSERT_FALSE(report.is_null());
  const double voxel = report["grid"]["voxel"].get<double>();
  const Mesh finer = read_mesh(levels + "/level_-1.ply"), own = read_mesh(levels + "/level_0.ply");
  EXPECT_TRUE(check_topology(own).watertight());
  EXPECT_FALSE(check_topology(finer).closed());
  EXPECT_GT(finer.triangles.size(), 1000u);
  double lowest = 1;
  for (const Vec3d v : finer.vertices) {
    EXPECT_NEAR(norm(v), 1, 2 * voxel);
    lowest = std::min(lowest, v.z);
  }
  EXPECT_GT(lowest, 0);
}

TEST_F(MethodCommand, SamplesThatAreRefusedLeaveNoFolderForLevels) {
  const std::string levels = folder.file("levels"), flat = folder.file("flat.xyz");
  std::ofstream(flat) << "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0.5 0.5 0\n";
  const ProcessResult result = run({"reconstruct", flat, "-o", mesh, "--write-levels", levels});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_TRUE(contains(result.err, "flat.xyz: all 5 samples are coplanar")) << result.err;
  EXPECT_FALSE(std::filesystem::exists(levels));
}

TEST_F(MethodCommand, LevelsWithoutASurfaceLeaveTheOutcomeAsItIs) {
  const std::string levels = folder.file("levels");
  const ProcessResult result = run({"reconstruct", even, "-o", mesh, "--write-levels", levels, "--resolution",
                                    resolution, "--lambda", "9", "--quiet"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(contains(result.err, "the largest lambda that keeps a surface")) << result.err;
  EXPECT_TRUE(std::filesystem::is_empty(levels));
}

TEST_F(MethodCommand, NoLevelsStayOfARunThatFails) {
  const std::string levels = folder.file("levels");
  const ProcessResult result = run({"reconstruct", even, "-o", mesh, "--write-levels", levels, "--resolution", "17",
                                    "--isovalue", "0.999", "--quiet"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(std::filesystem::is_empty(levels));
}

TEST_F(MethodCommand, VripTakesTheSensorOfScansThatNameNone) {
  ScannerParams scanner;
  scanner.step = 0.03;
  scanner.views = 1;
  PointCloud cloud = virtual_scan(*make_sphere(), scanner, Context(1)).cloud;
  ASSERT_EQ(cloud.scans.size(), 1u);
  const Vec3d center = cloud.box().center();
  ASSERT_GT(norm(center), 0.1) << "one side of a sphere around the origin: the scanner is on that side";
  cloud.scans[0].sensor.reset();
  cloud.scans[0].view_direction.reset();
  cloud.sensors.clear();
  const std::string blind = folder.file("blind.ply");
  write_points(blind, cloud);
  refused({blind, "--method", "vrip"}, "has no sensor position and no viewing direction");
  const Vec3d sensor = (3 / norm(center)) * center;
  const json report = reported({blind, "--method", "vrip", "--resolution", resolution, "--sensor",
                                fmt::format("{},{},{}", sensor.x, sensor.y, sensor.z)});
  ASSERT_FALSE(report.is_null());
  EXPECT_GT(report["mesh"]["triangles"], 100);
}

TEST_F(MethodCommand, WritesLevelsByTvAloneAndIntoAFolder) {
  const std::string levels = folder.file("levels");
  refused({even, "--method", "tv-sor", "--write-levels", levels}, "--write-levels: only method tv has it");
  EXPECT_FALSE(std::filesystem::exists(levels));
  refused({even, "--write-levels", even + "/levels"}, "cannot make the folder");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
