// --split: the mesh of a run in several files.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cli/reconstruct_runs.h"
#include "soapfilm/io.h"

namespace soapfilm::test {
namespace TEST_FILE {

namespace fs = std::filesystem;
using Corners = std::array<std::array<double, 3>, 3>;

std::multiset<Corners> triangles_of(const std::string& file) {
  const Mesh mesh = read_mesh(file);
  std::multiset<Corners> all;
  for (const Triangle& t : mesh.triangles) {
    Corners corners{};
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.vertices[t[k]];
      corners[k] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.insert(corners);
  }
  return all;
}

class Split : public ReconstructRuns {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"scan", "sphere", "--samples", "4000", "-o", folder.file("scan"), "-q"}).exit_code, 0);
    cloud = folder.file("scan") + "/samples.ply";
  }
  ProcessResult split(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"reconstruct", cloud, "--resolution", "32", "-o", output});
    return run(more);
  }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& file : fs::directory_iterator(folder.path())) all.insert(file.path().filename());
    all.erase("scan");
    return all;
  }
  std::string cloud;
};

TEST_F(Split, ThePartsAreTheMesh) {
  for (const std::string extension : {".ply", ".obj", ".stl", ".off", ".glb"}) {
    const std::string whole = folder.file("whole" + extension), parts = folder.file("city" + extension);
    ASSERT_EQ(split(whole, {"-q"}).exit_code, 0);
    const ProcessResult result = split(parts, {"--split", "1000", "--report", folder.file("r.json")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_FALSE(fs::exists(parts));
    const auto index = nlohmann::json::parse(read_file(folder.file("city.parts.json")));
    std::multiset<Corners> all;
    for (const auto& part : index["parts"]) {
      const std::multiset<Corners> some = triangles_of(folder.file(part["file"]));
      EXPECT_LE(some.size(), 1000u);
      all.insert(some.begin(), some.end());
    }
    EXPECT_GT(index["files"], 1);
    EXPECT_EQ(all, triangles_of(whole)) << extension;
    const auto report = nlohmann::json::parse(read_file(folder.file("r.json")));
    EXPECT_EQ(report["mesh"]["triangles"], all.size());
    EXPECT_EQ(report["mesh"]["vertices"], index["vertices"]);
    EXPECT_EQ(report["mesh"]["parts"]["files"], index["files"]);
    EXPECT_TRUE(contains(result.err, "city.parts.json, " + std::to_string(index["files"].get<int>()) + " files: "))
        << result.err;
    fs::remove(folder.file("city.parts.json"));
  }
}

TEST_F(Split, TheSameBytesForAnyNumberOfThreads) {
  const std::vector<std::string> options{"--split", "700", "--attributes", "all", "--distance", "-q"};
  std::vector<std::string> one = options, two = options;
  one.insert(one.end(), {"--threads", "1"});
  two.insert(two.end(), {"--threads", "2"});
  for (const char* made : {"one", "two"}) fs::create_directory(folder.file(made));
  ASSERT_EQ(split(folder.file("one/m.ply"), one).exit_code, 0);
  ASSERT_EQ(split(folder.file("two/m.ply"), two).exit_code, 0);
  size_t files = 0;
  for (const auto& file : fs::directory_iterator(folder.file("one"))) {
    EXPECT_TRUE(read_file(file.path()) == read_file(folder.path() / "two" / file.path().filename())) << file.path();
    ++files;
  }
  EXPECT_GT(files, 3u);
}

TEST_F(Split, WithoutANumberOfItsOwnPartsAreLarge) {
  ASSERT_EQ(split(folder.file("m.ply"), {"--split", "auto", "-q"}).exit_code, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"m.part_001.ply", "m.parts.json"}));
  ASSERT_EQ(split(folder.file("whole.ply"), {"-q"}).exit_code, 0);
  EXPECT_EQ(triangles_of(folder.file("m.part_001.ply")), triangles_of(folder.file("whole.ply")));
}

/// Parts of an earlier run beside the scans are no scans, under whatever names.
TEST_F(Split, PartsAreNoScans) {
  const std::string scans = folder.file("scan");
  ASSERT_EQ(run_in(scans, {"reconstruct", "samples.ply", "--resolution", "32", "--split", "1000", "-q"}).exit_code, 0);
  ASSERT_TRUE(fs::exists(scans + "/samples.mesh.part_001.ply"));
  const ProcessResult again = run_in(scans, {"reconstruct", "sa*.ply", "--resolution", "32", "-o", "again.ply"});
  EXPECT_TRUE(contains(again.err, "in 1 scan\n")) << again.err;
  EXPECT_TRUE(contains(again.err, "samples.mesh.part_001.ply and 7 more: left out")) << again.err;
}

TEST_F(Split, RefusesWhatItCannotDo) {
  for (const std::string bad : {"0", "-1", "1.5", "many", "nan", "1e99"}) refused({cloud, "--split", bad}, "split");
  refused({cloud, "--split", "1000", "--simplify", "auto", "--lod", "2"}, "split: not together with --lod");
  expect_refused({"reconstruct", cloud, "-q", "-o", "-", "--split", "10"},
                 "split: several files cannot go to standard output");
  expect_refused({"reconstruct", cloud, "-q", "-o", folder.file("m.las"), "--split", "10"}, "extension '.las'");
  expect_refused({"reconstruct", cloud, "-q", "-o", folder.file("none/m.ply"), "--split", "10"},
                 "none/m.part_001.ply: cannot be written: No such file");
  for (const char* other : {"m.part_0017.ply", "m.parts.json"})
    expect_refused(
        {"reconstruct", cloud, "-q", "-o", folder.file("m.ply"), "--split", "10", "--report", folder.file(other)},
        "is named for two outputs");
  fs::copy(cloud, folder.file("m.part_002.ply"));
  expect_refused({"reconstruct", folder.file("m.part_002.ply"), "-q", "-o", folder.file("m.ply"), "--split", "10"},
                 "m.part_002.ply: is also an input");
  fs::remove(folder.file("m.part_002.ply"));
  fs::create_directory(folder.file("m.parts.json"));
  expect_refused({"reconstruct", cloud, "-q", "-o", folder.file("m.ply"), "--split", "10"},
                 "m.parts.json: is a directory");
  EXPECT_EQ(names(), std::set<std::string>{"m.parts.json"});
}

/// A disk that is full, a part that cannot be written: what was written goes.
TEST_F(Split, LeavesNothingWhereAPartCannotBeWritten) {
  fs::create_directory(folder.file("m.part_002.ply"));
  const std::set<std::string> before = names();
  const ProcessResult result = split(folder.file("m.ply"), {"--split", "1000", "-q"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "m.part_002.ply: is a directory")) << result.err;
  EXPECT_EQ(names(), before);

  const ProcessResult full =
      run_process({"/bin/sh", "-c", "trap '' XFSZ; ulimit -f 16; exec \"$@\"", "sh", SOAPFILM_PROGRAM, "reconstruct",
                   cloud, "--resolution", "32", "-q", "-o", folder.file("full.ply"), "--split", "1000"});
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_TRUE(contains(full.err, "full.part_00")) << full.err;
  EXPECT_TRUE(contains(full.err, "cannot be written: File too large")) << full.err;
  EXPECT_EQ(names(), before);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
