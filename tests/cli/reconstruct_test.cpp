// soapfilm reconstruct as a user runs it: input and output files, refusals, the empty result, cancelling.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "soapfilm/io.h"
#include "soapfilm/mesh/topology.h"
#include "support/program.h"
#include "support/sanitized.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

using nlohmann::json;

constexpr double radius = 0.5;

PointCloud sphere_cloud(size_t samples, Vec3d center = {}) {
  ShapeParams params;
  params.center = center;
  return sample_surface(*make_sphere(params), samples, 7);
}

/// A folder with a small cloud.
class Reconstruct : public testing::Test {
 protected:
  void SetUp() override { write_points(cloud, sphere_cloud(6000)); }

  size_t files() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
  }
  /// Refused with a message about `what`, and without a new file.
  void refused(std::vector<std::string> arguments, const std::string& what) {
    const size_t before = files();
    arguments.insert(arguments.begin(), {"reconstruct", "--quiet"});
    expect_refused(arguments, what);
    EXPECT_EQ(files(), before) << "something was written";
  }
  std::string text_file(const std::string& name, const std::string& text) {
    std::ofstream(folder.file(name)) << text;
    return folder.file(name);
  }

  TemporaryFolder folder;
  std::string cloud = folder.file("sphere.ply");
  std::string mesh = folder.file("mesh.ply");
};

/// A large program (a notebook, a service) starts a small run: the peak is that of the run.
TEST_F(Reconstruct, PeakOfMemoryIsItsOwnNotThatOfWhoStartedIt) {
  const size_t held = size_t{sanitized ? 1024 : 256} << 20;
  const std::vector<char> block(held, 'x');
  const volatile char* seen = block.data();  // an unused block might be optimized away
  ASSERT_EQ(seen[block.size() / 2], 'x');
  const std::string report = folder.file("report.json");
  const ProcessResult result =
      run({"reconstruct", cloud, "-o", mesh, "--resolution", "24", "--report", report, "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto peak = json::parse(read_file(report))["memory"]["peak_bytes"].get<size_t>();
  EXPECT_GT(peak, size_t{1} << 20);
  EXPECT_LT(peak, held);
}

/// Lambda is so small that single outliers pay for a surface.
TEST_F(Reconstruct, ReportsWhichComponentsItDropped) {
  SamplingParams scan;
  scan.count = sanitized ? 5500 : 11000;
  scan.outliers = 0.03;
  write_points(cloud, sample_surface(*make_sphere(), scan, Context(1)));
  const std::string report_file = folder.file("report.json");
  const std::vector<std::string> words{"reconstruct",           cloud,      "-o",     mesh,       "--resolution",
                                       sanitized ? "48" : "64", "--lambda", "0.0013", "--report", report_file};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  };
  const ProcessResult dropped = with({});
  ASSERT_EQ(dropped.exit_code, 0) << dropped.err;
  EXPECT_TRUE(contains(dropped.err, "dropped: only")) << dropped.err;
  const json report = json::parse(read_file(report_file));
  const json& components = report["surface"]["components"];
  EXPECT_GT(components["objects"]["dropped"].get<int>(), 10);
  EXPECT_EQ(components["objects"]["kept"], 1);
  EXPECT_EQ(components["min_support"], 0.2);
  EXPECT_GT(components["lowest_kept"].get<double>(), components["highest_dropped"].get<double>());
  EXPECT_EQ(report["surface"]["refine"]["vanished"], 0);
  EXPECT_EQ(report["mesh"]["components"], 1);

  const ProcessResult kept = with({"--drop-components", "off"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  const json all = json::parse(read_file(report_file));
  EXPECT_TRUE(all["surface"]["components"].is_null());
  EXPECT_GT(all["mesh"]["components"].get<int>(), 10);
  EXPECT_EQ(all["certificate"]["primal_binary"], report["certificate"]["primal_binary"]);

  const ProcessResult contradiction = with({"--drop-components", "off", "--min-support", "0.5"});
  EXPECT_EQ(contradiction.exit_code, 2);
  EXPECT_TRUE(contains(contradiction.err, "min_support = 0.5: components are kept (drop_components = off)"))
      << contradiction.err;
}

TEST_F(Reconstruct, MakesAWatertightMeshAndAReport) {
  const std::string report_file = folder.file("report.json");
  const int cells = sanitized ? 44 : 64;
  const std::string resolution = std::to_string(cells);
  const ProcessResult result =
      run({"reconstruct", cloud, "-o", mesh, "--resolution", resolution, "--report", report_file, "--check"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "segmentation proved within")) << result.err;
  EXPECT_TRUE(contains(result.err, "closed, manifold, 1 component, genus 0")) << result.err;

  const Mesh read = read_mesh(mesh);
  const TopologyReport topology = check_topology(read);
  EXPECT_TRUE(topology.watertight()) << summary(topology);
  EXPECT_NEAR(read.volume(), 4.0 / 3.0 * M_PI * radius * radius * radius, 0.02);

  const json report = json::parse(read_file(report_file));
  EXPECT_EQ(report["report_version"], 1);
  EXPECT_EQ(report["grid"]["size"], json({cells, cells, cells}));
  EXPECT_GT(report["grid"]["inside"].get<size_t>(), 0u);
  EXPECT_FALSE(report["grid"]["levels"].empty());
  const json& certificate = report["certificate"];
  EXPECT_LE(certificate["relative_gap"].get<double>(), 2e-3) << "1e-3 on the band, and what lies outside of it";
  EXPECT_LE(certificate["relative_gap_binary"].get<double>(), 2e-2);
  EXPECT_LE(certificate["dual"].get<double>(), certificate["primal"].get<double>());
  EXPECT_GT(report["seconds"]["solve"].get<double>(), 0);
  EXPECT_GE(report["seconds"]["total"].get<double>(), report["seconds"]["solve"].get<double>());
  EXPECT_GT(report["memory"]["planned_bytes"].get<size_t>(), 1u << 20);
  EXPECT_GT(report["memory"]["peak_bytes"].get<size_t>(), 1u << 20);
  EXPECT_EQ(report["mesh"]["vertices"], read.vertices.size());
  EXPECT_EQ(report["mesh"]["triangles"], read.triangles.size());
  EXPECT_EQ(report["mesh"]["closed"], true);
  EXPECT_EQ(report["mesh"]["manifold"], true);
  EXPECT_EQ(report["mesh"]["components"], 1);
  EXPECT_EQ(report["parameters"]["place"]["resolution"], cells);
  EXPECT_TRUE(contains(report["command"].get<std::string>(), "--resolution " + resolution));
  EXPECT_EQ(report["input"]["directions"]["normals"], 6000);
}

TEST_F(Reconstruct, SaysWhatItDoesInPlainLines) {
  if (sanitized) write_points(cloud, sphere_cloud(2000));  // a coarser grid
  const ProcessResult result = run({"reconstruct", cloud, "-o", mesh});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* word : {"read", "grid", "voxel", "lambda", "memory", "solve", "extract", "write"})
    EXPECT_TRUE(contains(result.err, word)) << word << " in: " << result.err;
  EXPECT_FALSE(contains(result.err, "\r")) << "no terminal control where there is no terminal";
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(run({"reconstruct", cloud, "-o", mesh, "--quiet"}).err, "");
}

TEST_F(Reconstruct, TheSameBytesForAnyNumberOfThreads) {
  std::string one;
  for (const char* threads : {"1", "2", "3", "8"}) {
    const ProcessResult result =
        run({"reconstruct", cloud, "-o", mesh, "--resolution", "96", "--threads", threads, "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::string bytes = read_file(mesh);
    if (one.empty()) one = bytes;
    EXPECT_TRUE(bytes == one) << threads << " threads";
  }
}

TEST_F(Reconstruct, WritesEachFormat) {
  for (const char* name : {"mesh.obj", "mesh.stl", "mesh.ply"}) {
    ASSERT_EQ(
        run({"reconstruct", cloud, "-o", folder.file(name), "--voxel", sanitized ? "0.05" : "0.03", "--ascii", "-q"})
            .exit_code,
        0);
    EXPECT_TRUE(check_topology(read_mesh(folder.file(name))).watertight()) << name;
  }
  EXPECT_TRUE(contains(read_file(mesh).substr(0, 40), "format ascii"));
}

TEST_F(Reconstruct, SeveralInputsAreSeveralScansSeenFromASensor) {
  // Two halves without normals around one scanner inside would be inside out; a scanner far above sees the upper half.
  PointCloud upper = sphere_cloud(6000);
  std::vector<bool> keep;
  for (const Vec3d& p : upper.positions) keep.push_back(p.z > 0.1);
  upper.filter(keep);
  upper.normals.clear();
  PointCloud left, right;
  std::vector<bool> is_left;
  for (const Vec3d& p : upper.positions) is_left.push_back(p.x < 0);
  left = right = upper;
  left.filter(is_left);
  is_left.flip();
  right.filter(is_left);
  write_points(folder.file("left.ply"), left);
  write_points(folder.file("right.ply"), right);
  const std::string report = folder.file("r.json");
  const ProcessResult result = run({"reconstruct", folder.file("left.ply"), folder.file("right.ply"), "-o", mesh,
                                    "--sensor", "0,0,10", "--resolution", "64", "--report", report});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json read = json::parse(read_file(report));
  EXPECT_EQ(read["input"]["scans"], 2);
  EXPECT_EQ(read["input"]["directions"]["sensor"], left.size() + right.size());
  EXPECT_EQ(read["mesh"]["components"], 1);
}

TEST_F(Reconstruct, GeoreferencedInputLosesNothing) {
  // The offset is a multiple of the resolution of double there, so the shifted samples are exact.
  const Vec3d offset{5000000, -5000000, 5000000};
  PointCloud near = sphere_cloud(6000);
  for (Vec3d& p : near.positions) p = (p + offset) - offset;
  PointCloud far = near;
  for (Vec3d& p : far.positions) p += offset;
  write_points(folder.file("near.ply"), near);
  write_points(folder.file("far.ply"), far);
  const double voxel = 0.02;
  for (const char* name : {"near", "far"})
    ASSERT_EQ(run({"reconstruct", folder.file(std::string(name) + ".ply"), "-o",
                   folder.file(std::string(name) + "_mesh.ply"), "--voxel", std::to_string(voxel), "-q"})
                  .exit_code,
              0);
  const Mesh a = read_mesh(folder.file("near_mesh.ply")), b = read_mesh(folder.file("far_mesh.ply"));
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  double largest = 0;
  for (size_t i = 0; i < a.vertices.size(); ++i)
    largest = std::max(largest, norm(b.vertices[i] - offset - a.vertices[i]));
  EXPECT_LE(largest, 2e-3 * voxel) << "two roundings of 1e-3 voxel";
}

TEST_F(Reconstruct, RefusesBadParameters) {
  refused({cloud, "-o", mesh, "--resolution", "5"}, "resolution = 5, must be between 13");
  refused({cloud, "-o", mesh, "--resolution", "1000000"}, "resolution = 1000000, must be at most");
  refused({cloud, "-o", mesh, "--voxel", "-1"}, "voxel = -1, must be > 0");
  refused({cloud, "-o", mesh, "--voxel", "1e-9"}, "voxel = 1e-09");
  refused({cloud, "-o", mesh, "--voxel", "0.1", "--resolution", "64"}, "--resolution");
  refused({cloud, "-o", mesh, "--lambda", "0"}, "lambda = 0, must be > 0");
  refused({cloud, "-o", mesh, "--tolerance", "nan"}, "tolerance = nan, must be > 0");
  refused({cloud, "-o", mesh, "--threshold", "1"}, "threshold = 1, must be > 0 and < 1");
  refused({cloud, "-o", mesh, "--isovalue", "middle"}, "isovalue = middle");
  refused({cloud, "-o", mesh, "--voxel", "1e-300"}, "must be <= 268435456");
  refused({cloud, "-o", mesh, "--voxel", "3"}, "voxel = 3, must be <= 0.99");
  refused({cloud, "-o", mesh, "--lambda", "inf"}, "lambda = inf, must be > 0 and <= 1e24");
  refused({cloud, "-o", mesh, "--padding", "1"}, "padding = 1, must be >= 2");
  refused({cloud, "-o", mesh, "--padding", "2147483647", "--resolution", "40"}, "must be >= 2 and <= 4096");
  refused({cloud, "-o", mesh, "--max-iterations", "0"}, "max_iterations = 0, must be >= 1");
  refused({cloud, "-o", mesh, "--directions", "up"}, "up");
  refused({cloud, "-o", mesh, "--directions", "scan"}, "scan");
  refused({cloud, "-o", mesh, "--sensor", "1,2"}, "sensor");
  refused({cloud, "-o", mesh, "--memory", "lots"}, "lots");
  refused({cloud, "-o", mesh, "--color"}, "--color");
}

TEST_F(Reconstruct, RefusesWhatDoesNotFitAndSaysWhatWould) {
  refused({cloud, "-o", mesh, "--resolution", "512", "--memory", "100M"}, "a resolution of about");
}

TEST_F(Reconstruct, RefusesBadInput) {
  refused({folder.file("absent.ply"), "-o", mesh}, "absent.ply");
  refused({text_file("words.ply", "hello\n"), "-o", mesh}, "words.ply");
  refused({text_file("cloud.e57", "x"), "-o", mesh}, "e57");
  const std::string whole = read_file(cloud);
  refused({text_file("short.ply", whole.substr(0, whole.size() / 2)), "-o", mesh}, "short.ply");
  refused({text_file("nan.xyz", "nan 0 0\n0 inf 0\n"), "-o", mesh}, "nan.xyz");
  refused({text_file("one.xyz", "1 2 3 0 0 1\n"), "-o", mesh}, "one.xyz: 1 sample, must be at least 4");
  refused({text_file("same.xyz", "1 2 3 0 0 1\n1 2 3 0 0 1\n1 2 3 0 0 1\n1 2 3 0 0 1\n"), "-o", mesh},
          "same.xyz: all 4 samples are identical");
  std::string plane;
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y) plane += std::to_string(x) + " " + std::to_string(y) + " 5 0 0 1\n";
  refused({text_file("plane.xyz", plane), "-o", mesh}, "plane.xyz: all 400 samples are coplanar");
  refused({text_file("huge.xyz", "0 0 0\n1e300 0 0\n0 1e300 0\n0 0 1e300\n"), "-o", mesh},
          "huge.xyz: the longest side of the samples' box = 1e+300, must be in [1e-100, 1e+100]");
  refused({text_file("far.xyz", "1e15 0 0 0 0 1\n1000000000000001 0 0 0 0 1\n1e15 1 0 0 0 1\n1e15 0 1 0 0 1\n"), "-o",
           mesh, "--resolution", "20"},
          "nearer to the origin");
  refused({text_file("set.conf", "bmesh absent.ply 0 0 0 0 0 0 1\n"), "-o", mesh}, "set.conf: ");
}

/// Raw scans cannot be measured again.
TEST_F(Reconstruct, OutputsTakeTheirOwnPlacesOnly) {
  const std::string before = read_file(cloud);
  refused({cloud, "-o", cloud}, "is also an input");
  refused({cloud, "-o", folder.file("../" + folder.path().filename().string() + "/sphere.ply")}, "is also an input");
  refused({cloud, "-o", mesh, "--report", cloud}, "sphere.ply: is also an input");
  refused({cloud, "-o", mesh, "--report", mesh}, "mesh.ply: is named for two outputs");
  refused({cloud, "-o", "absent.ply", "--report", "./absent.ply"}, "./absent.ply: is named for two outputs");
  refused({text_file("set.conf", "bmesh sphere.ply 0 0 0 0 0 0 1\n"), "-o", cloud}, "is also an input");
  refused({cloud, "-o", folder.file("level_3.ply"), "--write-levels", folder.path().string()}, "two outputs");
  const std::string link = folder.file("link.ply");
  std::filesystem::create_symlink(cloud, link);
  refused({cloud, "-o", link}, "link.ply: is also an input");
  EXPECT_EQ(read_file(cloud), before);
}

TEST_F(Reconstruct, AMeshWithoutItsReportIsWarnedOf) {
  expect_refused({"reconstruct", "-q", cloud, "-o", mesh, "--resolution", "24", "--report", "/dev/full"},
                 "mesh.ply is written all the same");
  EXPECT_TRUE(std::filesystem::exists(mesh));
}

TEST_F(Reconstruct, ASampleFarAwayIsNamedWhereItCosts) {
  PointCloud far = sphere_cloud(6000);
  far.positions[17] = {1e4, 1e4, 0};
  far.normals[17] = {1, 1, 0};
  write_points(folder.file("far.ply"), far);
  refused({folder.file("far.ply"), "-o", mesh, "--memory", "200M", "--method", "poisson"},
          "far away, one at (10000, 10000, 0)");
  EXPECT_EQ(run({"reconstruct", "--quiet", folder.file("far.ply"), "-o", mesh, "--memory", "200M"}).exit_code, 0);
}

/// Pixels without depth, all at the camera's origin, must not decide how fine the grid is.
TEST_F(Reconstruct, SamplesAtOnePlaceDoNotRefineTheGrid) {
  constexpr size_t repeated = sanitized ? 500 : 1500, others = 4 * repeated;
  PointCloud pixels = sphere_cloud(others);
  pixels.positions.insert(pixels.positions.end(), repeated, Vec3d{0.01, 0, 0});
  pixels.normals.insert(pixels.normals.end(), repeated, Vec3f{});
  pixels.scans[0].end += repeated;
  write_points(folder.file("pixels.ply"), pixels);
  const ProcessResult result = run({"reconstruct", folder.file("pixels.ply"), "-o", mesh, "--directions", "normals"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string warning = fmt::format("warning: {} of {} samples are where another one is, most at (0.01, 0, 0)",
                                          repeated - 1, others + repeated);
  EXPECT_TRUE(contains(result.err, warning)) << result.err;
}

TEST_F(Reconstruct, RefusesUnwritableOutputBeforeTheRun) {
  refused({cloud, "-o", folder.file("no/such/folder/mesh.ply")}, "mesh.ply");
  refused({cloud, "-o", folder.file("mesh.docx")}, "docx");
  refused({cloud, "-o", mesh, "--report", folder.file("no/report.json")}, "report.json");
}

TEST_F(Reconstruct, AnEmptyOptimumIsItsOwnOutcome) {
  const ProcessResult result =
      run({"reconstruct", cloud, "-o", mesh, "--resolution", sanitized ? "40" : "64", "--lambda", "5"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(contains(result.err, "lambda = 5")) << result.err;
  EXPECT_TRUE(contains(result.err, "largest lambda that keeps a surface is about")) << result.err;
  EXPECT_TRUE(contains(result.err, "warning")) << "a warning comes before the solve: " << result.err;
  EXPECT_FALSE(std::filesystem::exists(mesh));
}

TEST_F(Reconstruct, AnIsovalueThatLeavesNothingIsAnEmptyResult) {
  const ProcessResult result = run({"reconstruct", cloud, "-o", mesh, "--resolution", "17", "--isovalue", "0.999"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(contains(result.err, "isovalue 0.999")) << result.err;
  EXPECT_FALSE(std::filesystem::exists(mesh));
}

TEST_F(Reconstruct, CtrlCLeavesNothingBehind) {
  const size_t before = files();
  const auto begin = std::chrono::steady_clock::now();
  const ProcessResult result =
      run({"reconstruct", cloud, "-o", mesh, "--resolution", "400", "--lambda", "0.3", "--tolerance", "1e-9"},
          [](pid_t program) {
            std::this_thread::sleep_for(std::chrono::milliseconds(700));
            kill(program, SIGINT);
          });
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_TRUE(contains(result.err, "cancelled")) << result.err;
  EXPECT_EQ(files(), before);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60)) << "it must not run to its end";
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
