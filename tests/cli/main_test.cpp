// The program as a user runs it: pages, refusals and exit codes that are the same for every sub-command.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "soapfilm/version.h"
#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

TEST(Program, PrintsItsVersion) {
  const ProcessResult result = run({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "soapfilm " + std::string(version) + "\n");
  EXPECT_EQ(result.err, "");
}

TEST(Program, HelpIsAPage) {
  const ProcessResult result = run({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* word :
       {"reconstruct", "scan", "evaluate", "info", "render", "--threads", "--quiet", "EXAMPLES", "EXIT CODES"})
    EXPECT_TRUE(contains(result.out, word)) << word;
  EXPECT_EQ(run({}).out, result.out) << "without arguments the same page";
}

TEST(Program, HelpFitsAHundredColumns) {
  for (const char* command : {"", "reconstruct", "scan", "evaluate", "info", "render"}) {
    std::istringstream page(
        run(*command ? std::vector<std::string>{command, "--help"} : std::vector<std::string>{}).out);
    for (std::string line; std::getline(page, line);) EXPECT_LE(line.size(), 100u) << command << ": " << line;
  }
}

TEST(Program, EverySubCommandHasAPage) {
  for (const char* command : {"reconstruct", "scan", "evaluate", "info", "render"}) {
    const ProcessResult result = run({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_TRUE(contains(result.out, "Usage: soapfilm " + std::string(command))) << result.out;
    EXPECT_TRUE(contains(result.out, "Global options")) << result.out;
  }
}

TEST(Program, RefusesWhatItDoesNotKnow) {
  expect_refused({"--bogus"}, "unknown option '--bogus'");
  expect_refused({"bogus"}, "unknown command 'bogus'");
  for (const char* command : {"reconstruct", "scan", "evaluate", "info", "render"})
    expect_refused({command, "--bogus"}, "'--bogus'");
}

TEST(Program, RefusesBadGlobalOptions) {
  expect_refused({"--threads", "many", "info", "x.ply"}, "many");
  expect_refused({"info", "x.ply", "--threads", "-1"}, "-1");
  expect_refused({"-q", "-v", "info", "x.ply"}, "--quiet");
}

TEST(Program, NamesAFileThatIsNotThere) {
  expect_refused({"info", "/nowhere/scan.ply"}, "/nowhere/scan.ply");
  expect_refused({"-q", "reconstruct", "/nowhere/scan.ply", "-o", "/tmp/never.ply"}, "/nowhere/scan.ply");
  expect_refused({"-q", "render", "/nowhere/mesh.ply", "-o", "/tmp/never.png"}, "/nowhere/mesh.ply");
  expect_refused({"render", "a.ply", "-o", "/tmp/never.png", "--range", "0,1"}, "--range: only --color-by has it");
}

TEST(Program, NoticesThatItsOutputWasLost) {
  const ProcessResult result = run_process({"/bin/sh", "-c", "\"$0\" --help > /dev/full", SOAPFILM_PROGRAM});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "soapfilm: standard output: cannot write\n");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
