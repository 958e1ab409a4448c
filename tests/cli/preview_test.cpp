// soapfilm reconstruct where -o is left out, and --preview.
#include "cli/preview.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/shell.h"
#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

class WithoutOutput : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"scan", "torus", "-q", "-o", folder.file("in"), "--samples", "20000"}).exit_code, 0);
    std::filesystem::rename(folder.file("in/samples.ply"), folder.file("in/my torus.ply"));
    std::filesystem::create_directory(here);
  }
  bool is_here(const std::string& name) const { return std::filesystem::exists(here + "/" + name); }

  TemporaryFolder folder;
  std::string here = folder.file("here");
  std::string input = folder.file("in/my torus.ply");
};

TEST_F(WithoutOutput, TheMeshIsInTheCurrentFolderUnderTheInputsName) {
  const ProcessResult result = run_in(here, {"reconstruct", input, "--resolution", "48"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(is_here("my torus.mesh.ply"));
  EXPECT_TRUE(contains(result.err, "my torus.mesh.ply: ")) << "says where: " << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder.file("in/my torus.mesh.ply")));
}

TEST_F(WithoutOutput, OfSeveralInputsTheFirstNamesIt) {
  std::filesystem::copy(input, folder.file("in/b.ply"));
  ASSERT_EQ(run_in(here, {"-q", "reconstruct", folder.file("in/b.ply"), input, "--resolution", "48"}).exit_code, 0);
  EXPECT_TRUE(is_here("b.mesh.ply"));
}

TEST_F(WithoutOutput, AnInputIsNeverOverwritten) {
  std::filesystem::copy(input, here + "/a.ply");
  std::filesystem::copy(input, here + "/a.mesh.ply");
  const std::string before = read_file(here + "/a.mesh.ply");
  const ProcessResult result = run_in(here, {"-q", "reconstruct", "a.ply", "a.mesh.ply", "--resolution", "48"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "a.mesh.ply: is also an input")) << result.err;
  EXPECT_EQ(read_file(here + "/a.mesh.ply"), before);
  ASSERT_EQ(run_in(here, {"-q", "reconstruct", "a.mesh.ply", "--resolution", "48"}).exit_code, 0);
  EXPECT_TRUE(is_here("a.mesh.mesh.ply"));
  EXPECT_EQ(read_file(here + "/a.mesh.ply"), before);
}

TEST_F(WithoutOutput, APreviewIsCoarserAndNamesTheFullRun) {
  const ProcessResult result =
      run_in(here, {"reconstruct", "--preview", input, "--resolution", "172", "--report", "r.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(is_here("my torus.preview.ply"));
  EXPECT_FALSE(is_here("my torus.mesh.ply"));
  EXPECT_TRUE(contains(result.err, "full run: soapfilm reconstruct '" + input + "' --resolution 172 --report r.json\n"))
      << result.err;
  const auto report = nlohmann::json::parse(read_file(here + "/r.json"));
  EXPECT_EQ(report["parameters"]["place"]["resolution"], 52);  // 12 of padding, a quarter of 160
}

/// The line after "full run: ".
std::string full_run_of(const std::string& messages) {
  const size_t begin = messages.find("full run: ") + 10;
  return messages.substr(begin, messages.find('\n', begin) - begin);
}

TEST_F(WithoutOutput, TheFullRunIsACommandThatAShellRuns) {
  const std::string odd = here + "/it's $HOME & \"more\".ply";
  std::filesystem::copy(input, odd);
  const ProcessResult preview =
      run_in(here, {"reconstruct", odd, "--preview", "--resolution", "60", "-o", "odd name.ply"});
  ASSERT_EQ(preview.exit_code, 0) << preview.err;
  std::filesystem::remove(here + "/odd name.ply");
  std::string command = full_run_of(preview.err);
  ASSERT_EQ(command.rfind("soapfilm ", 0), 0u) << command;
  command.replace(0, 8, SOAPFILM_PROGRAM);
  const ProcessResult full = run_process({"/bin/sh", "-c", "cd '" + here + "' && " + command});
  EXPECT_EQ(full.exit_code, 0) << full.err;
  EXPECT_TRUE(is_here("odd name.ply"));
}

PointCloud grid_cloud(size_t count) {
  PointCloud cloud;
  const auto side = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  for (size_t i = 0; i < count; ++i)
    cloud.positions.push_back({static_cast<double>(i % side), static_cast<double>(i / side), 0});
  cloud.scans.push_back({"grid", 0, count, {}, {}, {}});
  return cloud;
}

TEST(Preview, KeepsTheWeightOfAreaRelativeToTheSamplesOfAFace) {
  Progress progress;
  for (const size_t count : {size_t{1000}, size_t{400'000}}) {
    PointCloud cloud = grid_cloud(count);
    ReconstructParams params;
    params.place.voxel = 2;
    params.energy.lambda = 0.1;
    const double per_face = static_cast<double>(cloud.size());
    cli::make_preview(params, cloud, progress);
    const double larger = *params.place.voxel / 2;
    EXPECT_GE(larger, 1);
    EXPECT_LE(larger, 4);
    const double held = larger * larger * static_cast<double>(cloud.size()) / per_face;  // by a face now, over then
    EXPECT_NEAR(*params.energy.lambda / 0.1 / held, 1, 0.05) << count;
  }
}

TEST(Preview, OfManySamplesLeavesAnEvenPart) {
  Progress progress;
  PointCloud cloud = grid_cloud(400'000);
  ReconstructParams params;
  cli::make_preview(params, cloud, progress);
  EXPECT_NEAR(static_cast<double>(cloud.size()), 100'000, 2000);
  size_t even_rows = 0;
  for (const Vec3d& p : cloud.positions) even_rows += std::fmod(p.y, 2) == 0;
  EXPECT_NEAR(static_cast<double>(even_rows) / static_cast<double>(cloud.size()), 0.5, 0.01);
  EXPECT_NEAR(params.place.samples_per_voxel2, 4, 1e-12) << "16 for the voxel, one sample of 4";
  PointCloud few = grid_cloud(1000);
  cli::make_preview(params, few, progress);
  EXPECT_EQ(few.size(), 1000u);
}

TEST(Preview, KeepsAllSamplesForVrip) {
  Progress progress;
  PointCloud cloud = grid_cloud(400'000);
  ReconstructParams params;
  params.method = Method::vrip;
  cli::make_preview(params, cloud, progress);
  EXPECT_EQ(cloud.size(), 400'000u);
}

TEST(ShellWord, IsReadBackByAShell) {
  for (const std::string word : {"plain", "", "a b", "it's", "$HOME", "`x`", "a\"b", "\\", "*", "~", "-x", "tab\tend",
                                 "line\nend", "'\n'", "\\\n", "caf\xc3\xa9"}) {
    const std::string quoted = cli::shell_word(word);
    EXPECT_EQ(quoted.find('\n'), std::string::npos) << "one line";
    const ProcessResult echo = run_process({"/bin/bash", "-c", "printf %s " + quoted});
    EXPECT_EQ(echo.out, word) << quoted;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
