// What may stand in the place of input and output files: folders, the program's own meshes, standard streams.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "soapfilm/io/sets/input_files.h"
#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

/// Three scans of a sphere, in a folder.
class Inputs : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"scan", "sphere", "--views", "3", "--image", "24x24", "-o", folder.file("made"), "-q"}).exit_code,
              0);
    std::filesystem::create_directory(scans);
    int number = 8;
    for (const char* name : {"scan_000.ply", "scan_001.ply", "scan_002.ply"})
      std::filesystem::copy(folder.file("made") + "/" + name, scans + "/view_" + std::to_string(number++) + ".ply");
  }
  /// A shell in the folder of the scans; $SOAPFILM is the program.
  ProcessResult shell(const std::string& commands) const {
    return run_process({"/bin/sh", "-c", "cd '" + scans + "' && SOAPFILM=" + SOAPFILM_PROGRAM + " && " + commands});
  }
  TemporaryFolder folder;
  std::string scans = folder.file("scans");
};

TEST_F(Inputs, AFolderIsItsScansInTheOrderOfTheirNumbers) {
  std::vector<std::string> warnings;
  const std::vector<std::string> found = io::input_files({scans}, warnings);
  EXPECT_EQ(found, (std::vector<std::string>{scans + "/view_8.ply", scans + "/view_9.ply", scans + "/view_10.ply"}));
  EXPECT_TRUE(warnings.empty());
  const ProcessResult result = shell("$SOAPFILM info --json . && $SOAPFILM reconstruct ./ --resolution 32");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)[0]["scans"].size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(scans + "/scans.mesh.ply"));
}

TEST_F(Inputs, TheMeshOfAnEarlierRunIsNoScan) {
  const std::string all = "$SOAPFILM reconstruct *.ply --resolution 32 ";
  const ProcessResult first = shell(all + "&& $SOAPFILM reconstruct *.ply --preview --resolution 32");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const ProcessResult again = shell(all + "-o again.ply");
  EXPECT_TRUE(contains(again.err, "in 3 scans")) << again.err;
  for (const char* own : {"view_10.mesh.ply: left out", "view_10.preview.ply: left out"})
    EXPECT_TRUE(contains(again.err, own)) << again.err;
  EXPECT_EQ(shell("$SOAPFILM reconstruct view_10.mesh.ply --resolution 32 -o alone.ply").exit_code, 0);
}

TEST_F(Inputs, AFolderWithoutScansIsRefused) {
  std::filesystem::create_directory(folder.file("empty"));
  expect_refused({"reconstruct", folder.file("empty")}, "empty: a folder without scans");
  expect_refused({"info", folder.file("empty")}, "empty: a folder without scans");
}

TEST_F(Inputs, TextIsReadOnlyWhereThereIsNothingElse) {
  const std::string notes = scans + "/notes.txt";
  std::ofstream(notes) << "a note\n";
  std::vector<std::string> warnings;
  EXPECT_EQ(io::input_files({scans}, warnings).size(), 3u);
}

TEST_F(Inputs, StandardStreamsGiveTheBytesOfFiles) {
  const ProcessResult result = shell(
      "$SOAPFILM reconstruct view_8.ply --resolution 32 -q -o file.stl &&"
      "$SOAPFILM reconstruct - --resolution 32 -q -o - --format ,stl < view_8.ply > pipe.stl && cmp file.stl pipe.stl "
      "&&"
      "echo '0 0 0 1' | $SOAPFILM info - --format xyz | head -1");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "standard input\n");
}

TEST_F(Inputs, StandardInputIsRefusedByItsName) {
  const auto refused = [&](const std::string& command, const std::string& what) {
    const ProcessResult result = shell(command);
    EXPECT_EQ(result.exit_code, 2) << command;
    EXPECT_EQ(result.out, "") << command;
    EXPECT_TRUE(contains(result.err, what)) << result.err;
    EXPECT_FALSE(contains(result.err, "/soapfilm-")) << "a name nobody knows: " << result.err;
  };
  refused("echo 1 2 | $SOAPFILM reconstruct - -o - -q", "standard input:1: 2 columns");
  refused("$SOAPFILM reconstruct - -o - -q < /dev/null", "standard input: 0 bytes");
  refused("$SOAPFILM reconstruct - < view_8.ply", "must be given with -o");
  refused("$SOAPFILM reconstruct - - -o - < view_8.ply", "can be read once");
  refused("$SOAPFILM reconstruct - -o - --format ply,txt < view_8.ply", "standard output: extension '.txt'");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
