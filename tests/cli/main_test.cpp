// The program as a user runs it: pages, refusals and exit codes that are the same for every sub-command.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/version.h"
#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

TEST(Program, PrintsItsVersionAndHowItWasBuilt) {
  const ProcessResult result = run({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out.substr(0, result.out.find('\n')), "soapfilm " + std::string(version));
  for (const char* fact : {"built by: ", "built for: ", "SIMD: ", "threads: ", "OpenVDB: ", "libraries: ", "license: "})
    EXPECT_TRUE(contains(result.out, fact)) << fact;
  EXPECT_TRUE(contains(result.out, simd_targets().front())) << result.out;
  EXPECT_FALSE(contains(result.out, "@")) << "a fact is not filled in: " << result.out;
}

/// Text fits a screen of this size.
void expect_fits(const std::string& text, size_t lines, size_t columns) {
  EXPECT_LE(static_cast<size_t>(std::count(text.begin(), text.end(), '\n')), lines);
  std::istringstream page(text);
  for (std::string line; std::getline(page, line);) EXPECT_LE(line.size(), columns) << line;
}

/// Pages are as wide as the terminal, 40 to 120 columns: the shell says in COLUMNS how wide that is.
TEST(Program, ItsPagesFitTheTerminal) {
  for (const size_t columns : {20, 40, 57, 80, 120, 200})
    for (const char* command :
         {"", "reconstruct", "scan", "evaluate", "simplify", "remesh", "info", "render", "view"}) {
      const ProcessResult result = run_process(
          {"/bin/sh", "-c", "COLUMNS=" + std::to_string(columns) + " " + SOAPFILM_PROGRAM + " help " + command});
      EXPECT_EQ(result.exit_code, 0) << result.err;
      const size_t page = std::clamp<size_t>(columns, 40, 120);
      expect_fits(result.out, 1000, page);
      size_t longest = 0;
      std::istringstream lines(result.out);
      for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
      EXPECT_GT(longest, page * 3 / 4) << command << ": the page is not used";
    }
}

TEST(Program, HelpOfACommandIsItsPage) {
  EXPECT_EQ(run({"help", "info"}).out, run({"info", "--help"}).out);
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  expect_refused({"help", "inffo"}, "unknown command 'inffo', did you mean 'info'");
}

TEST(Program, AloneShowsTheWayToAFirstMeshOnOneScreen) {
  const ProcessResult result = run({});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  expect_fits(result.out, 22, 80);  // two lines are left for the command and the next prompt
  for (const char* word : {"soapfilm reconstruct ", "soapfilm scan ", "--preview", "--help"})
    EXPECT_TRUE(contains(result.out, word)) << word;
}

TEST(Program, TheCommandsOfItsFirstPageWork) {
  const TemporaryFolder folder;
  std::istringstream page(run({}).out);
  int tried = 0;
  for (std::string line; std::getline(page, line);) {
    const size_t command = line.find("soapfilm "), remark = line.find("  ", command);
    if (line.rfind("  ", 0) != 0 || !contains(line, "knot")) continue;
    std::istringstream words(line.substr(command, remark - command));
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    arguments[0] = "-q";
    if (arguments[1] == "scan") arguments.insert(arguments.end(), {"--views", "8", "--image", "60x60"});
    if (arguments[1] == "reconstruct") arguments.insert(arguments.end(), {"--resolution", "64"});
    if (arguments[1] == "evaluate") arguments.insert(arguments.end(), {"--points", "10000"});
    if (arguments[1] == "render") arguments.insert(arguments.end(), {"--size", "80x60"});
    const ProcessResult result = run_in(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.err;
    ++tried;
  }
  EXPECT_EQ(tried, 4);
  EXPECT_TRUE(std::filesystem::exists(folder.file("knot.png")));
}

TEST(Program, HelpIsAPage) {
  const ProcessResult result = run({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* word : {"reconstruct", "scan", "evaluate", "simplify", "remesh", "info", "render", "--threads",
                           "--quiet", "EXAMPLES", "EXIT CODES"})
    EXPECT_TRUE(contains(result.out, word)) << word;
  EXPECT_FALSE(contains(result.out, "completion")) << "hidden";
}

TEST(Program, HelpFitsAHundredColumns) {
  for (const char* command : {"", "reconstruct", "scan", "evaluate", "simplify", "remesh", "info", "render"}) {
    std::istringstream page(
        run(*command ? std::vector<std::string>{command, "--help"} : std::vector<std::string>{"--help"}).out);
    for (std::string line; std::getline(page, line);) EXPECT_LE(line.size(), 100u) << command << ": " << line;
  }
}

TEST(Program, EverySubCommandHasAPage) {
  for (const char* command : {"reconstruct", "scan", "evaluate", "simplify", "remesh", "info", "render"}) {
    const ProcessResult result = run({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_TRUE(contains(result.out, "Usage: soapfilm " + std::string(command))) << result.out;
    EXPECT_TRUE(contains(result.out, "Global options")) << result.out;
  }
}

TEST(Program, RefusesWhatItDoesNotKnow) {
  expect_refused({"--bogus"}, "unknown option '--bogus'");
  expect_refused({"bogus"}, "unknown command 'bogus'");
  for (const char* command : {"reconstruct", "scan", "evaluate", "simplify", "remesh", "info", "render"})
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

TEST(Program, IsNoOtherProgramThatMpirunStarted) {
  if (std::filesystem::exists(std::filesystem::path(SOAPFILM_PROGRAM).parent_path() / "soapfilm-mpi")) GTEST_SKIP();
  const auto of = [](const char* count) {
    return run_process({"/usr/bin/env", std::string("OMPI_COMM_WORLD_SIZE=") + count, SOAPFILM_PROGRAM, "--version"});
  };
  const ProcessResult several = of("2");
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_TRUE(contains(several.err, "soapfilm: mpirun: 2 processes, and soapfilm-mpi")) << several.err;
  EXPECT_EQ(of("1").exit_code, 0);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
