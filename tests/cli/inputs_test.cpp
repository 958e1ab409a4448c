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

TEST_F(Inputs, AFolderAndAPatternGiveTheBytesOfTheirFiles) {
  const ProcessResult result = shell(
      "opt='--resolution 32 -q -o' && $SOAPFILM reconstruct view_8.ply view_9.ply view_10.ply $opt ../named.ply &&"
      "$SOAPFILM reconstruct . $opt ../folder.ply && $SOAPFILM reconstruct 'view_*.ply' $opt ../pattern.ply &&"
      "$SOAPFILM reconstruct '../s?ans/view_[189]*' $opt ../pattern2.ply &&"
      "cd .. && for f in folder pattern pattern2; do cmp named.ply $f.ply || exit 1; done");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

TEST_F(Inputs, AFolderMayHoldItsOwnResult) {
  const ProcessResult result = shell(
      "opt='--resolution 32 -q -o' && $SOAPFILM reconstruct . $opt result.ply && $SOAPFILM reconstruct . $opt r2.ply &&"
      "cmp result.ply r2.ply");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "result.ply: left out, a mesh with faces")) << result.err;
  const ProcessResult refused = shell("$SOAPFILM reconstruct -q . -o view_9.ply");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(contains(refused.err, "view_9.ply: is also an input")) << refused.err;
}

TEST_F(Inputs, AFileThatIsNamedTwiceIsReadOnce) {
  const ProcessResult result = shell(
      "ln -s view_9.ply link.ply && opt='--resolution 32 -o' && $SOAPFILM reconstruct 'view_*.ply' -q $opt ../once.ply "
      "&&"
      "$SOAPFILM reconstruct 'view_*.ply' link.ply view_8.ply $opt ../twice.ply && cmp ../once.ply ../twice.ply");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "and 1 more files: are named twice, read once")) << result.err;
}

/// Each file that a pattern names by itself, a folder as a whole.
TEST_F(Inputs, InfoTellsOfAllThatAPatternNames) {
  const ProcessResult files = shell("$SOAPFILM info --json 'view_?.ply'"),
                      whole = shell("$SOAPFILM info --json ../scan*");
  ASSERT_EQ(files.exit_code, 0) << files.err;
  const auto facts = nlohmann::json::parse(files.out);
  ASSERT_EQ(facts.size(), 2u);
  EXPECT_EQ(facts[0]["file"], "view_8.ply");
  EXPECT_EQ(facts[1]["file"], "view_9.ply");
  const auto all = nlohmann::json::parse(whole.out);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0]["scans"].size(), 3u);
}

TEST_F(Inputs, OtherCommandsTakeFoldersToo) {
  const ProcessResult result = shell(
      "$SOAPFILM reconstruct . -q --resolution 32 -o ../m.ply && $SOAPFILM scan sphere -q -o ../truth --samples 100 &&"
      "$SOAPFILM evaluate ../m.ply --truth sphere --samples . --points 1000 > ../e1 &&"
      "$SOAPFILM evaluate ../m.ply --truth sphere --samples '*.ply' --points 1000 > ../e2 && grep -i samples ../e1 &&"
      "$SOAPFILM compare . ../m.ply --points 1000 | grep 'scan to model' &&"
      "$SOAPFILM compare 'view_*' ../m.ply --points 1000 | grep 'scan to model' &&"
      "$SOAPFILM render -q . '../m*.ply' -o ../p.png --size 40x40 --samples 1 --occlusion-rays 0");
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
}

TEST_F(Inputs, AFolderWithoutScansIsRefused) {
  std::filesystem::create_directory(folder.file("empty"));
  for (const char* command : {"reconstruct", "info"}) {
    expect_refused({command, folder.file("empty")}, "empty: a folder without scans, must hold files that end in .ply");
    expect_refused({command, folder.file("none")}, "none: cannot be opened: No such file or directory");
    expect_refused({command, folder.file("none/")}, "none/: no such folder");
    expect_refused({command, folder.file("empty/*.laz")}, "empty/*.laz: a pattern that no file matches");
    expect_refused({command, folder.file("none/[ab].laz")}, "none/[ab].laz: a pattern that no file matches");
  }
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
