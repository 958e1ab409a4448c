// Streams that are closed or full, and names that are no text.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

/// The program's arguments, run by a shell that redirects its streams.
int exit_code_in_shell(const std::string& arguments, const std::string& redirections) {
  return run_process({"/bin/sh", "-c", std::string(SOAPFILM_PROGRAM) + " " + arguments + " " + redirections}).exit_code;
}

class Streams : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"scan", "sphere", "--samples", "3000", "-o", folder.file("scan")}).exit_code, 0);
    input = folder.file("scan") + "/samples.ply";
    if (!std::filesystem::exists(input)) input = folder.file("scan") + "/scan.conf";
  }
  TemporaryFolder folder;
  std::string input;
};

TEST_F(Streams, WhatStandardErrorDoesNotTakeIsNotTold) {
  const std::string mesh = folder.file("mesh.ply");
  for (const char* err : {"2>/dev/full", "2>&-"}) {
    std::filesystem::remove(mesh);
    EXPECT_EQ(exit_code_in_shell("reconstruct --resolution 40 " + input + " -o " + mesh, err), 0) << err;
    EXPECT_TRUE(std::filesystem::exists(mesh)) << err;
    EXPECT_EQ(exit_code_in_shell("reconstruct --voxel -1 " + input + " -o " + mesh, err), 2) << err;
  }
}

TEST_F(Streams, AFullStandardOutputIsAnError) {
  EXPECT_EQ(exit_code_in_shell("info " + input, ">/dev/full"), 2);
  EXPECT_EQ(exit_code_in_shell("info --json " + input, ">/dev/full"), 2);
  EXPECT_EQ(exit_code_in_shell("--help", ">/dev/full"), 2);
}

TEST_F(Streams, NamesNeedNotBeText) {
  const std::string name = folder.file("scan \xff\xfe.ply"), mesh = folder.file("mesh \xe9.ply"),
                    report = folder.file("report.json");
  std::filesystem::copy(input, name);
  const ProcessResult result = run({"reconstruct", "--resolution", "40", name, "-o", mesh, "--report", report, "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(mesh));
  EXPECT_TRUE(nlohmann::json::parse(read_file(report)).contains("command"));
  EXPECT_EQ(run({"info", "--json", name}).exit_code, 0);
}

TEST_F(Streams, NamesOfSeveralLinesAreTakenAndToldInOne) {
  const std::string name = folder.file("two\nlines.ply"), mesh = folder.file("two\nlines.mesh.ply");
  std::filesystem::copy(input, name);
  const ProcessResult result = run({"reconstruct", "--resolution", "40", name, "-o", mesh});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(mesh));
  EXPECT_NE(result.err.find("two?lines.mesh.ply"), std::string::npos) << result.err;
  const ProcessResult missing = run({"reconstruct", "-q", folder.file("none\nsuch.ply")});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1) << missing.err;
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
