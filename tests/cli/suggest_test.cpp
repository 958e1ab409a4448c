// What was meant where another word was typed.
#include "cli/suggest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

using cli::edit_distance;
using cli::nearest;

TEST(EditDistance, CountsSingleEdits) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("voxel", "voxel"), 0u);
  EXPECT_EQ(edit_distance("voxl", "voxel"), 1u) << "dropped";
  EXPECT_EQ(edit_distance("voxeel", "voxel"), 1u) << "added";
  EXPECT_EQ(edit_distance("vozel", "voxel"), 1u) << "replaced";
  EXPECT_EQ(edit_distance("vxoel", "voxel"), 1u) << "exchanged";
  EXPECT_EQ(edit_distance("ca", "abc"), 3u) << "no part is edited twice";
}

TEST(EditDistance, IsSymmetricAndBounded) {
  const std::vector<std::string> words = {"", "a", "on", "off", "solid", "sensor", "scan", "scans", "resolution"};
  for (const std::string& a : words)
    for (const std::string& b : words) {
      const size_t distance = edit_distance(a, b);
      EXPECT_EQ(distance, edit_distance(b, a)) << a << ", " << b;
      EXPECT_GE(distance, std::max(a.size(), b.size()) - std::min(a.size(), b.size()));
      EXPECT_LE(distance, std::max(a.size(), b.size()));
      EXPECT_EQ(distance == 0, a == b);
    }
}

TEST(EditDistance, OfOneEditIsOneWhereverItIs) {
  const std::string word = "reconstruct";
  for (size_t i = 0; i < word.size(); ++i) {
    EXPECT_EQ(edit_distance(word, std::string(word).erase(i, 1)), 1u);
    EXPECT_EQ(edit_distance(word, std::string(word).insert(i, "z")), 1u);
    EXPECT_EQ(edit_distance(word, std::string(word).replace(i, 1, "z")), 1u);
    EXPECT_EQ(nearest(std::string(word).erase(i, 1), {"render", word, "scan"}), word);
  }
}

TEST(Nearest, TakesTheOneThatWasLikelyMeant) {
  const std::vector<std::string> options = {"--voxel", "--resolution", "--report", "--refine", "--ascii"};
  EXPECT_EQ(nearest("--resolutoin", options), "--resolution");
  EXPECT_EQ(nearest("--VOXEL", options), "--voxel");
  EXPECT_EQ(nearest("-voxel", options), "--voxel");
  EXPECT_EQ(nearest("--res", options), "--resolution") << "it alone begins so";
  EXPECT_EQ(nearest("--raport", options), "--report");
}

TEST(Nearest, SaysNothingWhereNoneIsNear) {
  const std::vector<std::string> options = {"--voxel", "--resolution", "--report", "--refine", "--ascii"};
  EXPECT_EQ(nearest("--bogus", options), "");
  EXPECT_EQ(nearest("--depth", options), "");
  EXPECT_EQ(nearest("", options), "");
  EXPECT_EQ(nearest("--", options), "");
  EXPECT_EQ(nearest("1", {"on", "off"}), "");
  EXPECT_EQ(nearest(std::string(100'000, 'r'), options), "") << "and soon";
}

TEST(Mistyped, CommandsAndOptionsNameTheNearest) {
  expect_refused({"reconstuct", "a.ply"}, "unknown command 'reconstuct', did you mean 'reconstruct'? (see soapfilm");
  expect_refused({"hlp"}, "did you mean '--help'?");
  expect_refused({"reconstruct", "a.ply", "--resolutoin", "256"},
                 "unknown option '--resolutoin', did you mean '--resolution'? (see soapfilm reconstruct --help)");
  expect_refused({"reconstruct", "a.ply", "--voxle=2"}, "unknown option '--voxle=2', did you mean '--voxel'?");
  expect_refused({"scan", "knot", "-o", "x", "--thread", "2"}, "did you mean '--threads'?");
  expect_refused({"--versoin"}, "did you mean '--version'?");
}

TEST(Mistyped, OptionsOfOtherCommandsSayWhose) {
  expect_refused({"evaluate", "a.ply", "--truth", "knot", "--lambda", "1"},
                 "unknown option '--lambda', it is one of soapfilm reconstruct");
}

TEST(Mistyped, LongOptionsWithOneDashAreNotReadAsShortOnes) {
  expect_refused({"reconstruct", "a.ply", "-voxel", "2"}, "unknown option '-voxel', did you mean '--voxel'?");
  expect_refused({"reconstruct", "a.ply", "-output=b.ply"}, "did you mean '--output'?");
  EXPECT_EQ(run({"reconstruct", "--help", "--", "-voxel"}).exit_code, 0) << "after -- nothing is an option";
}

TEST(Mistyped, ValuesNameTheNearest) {
  expect_refused({"reconstruct", "a.ply", "--method", "grph-cut-6"},
                 "must be one of tv, tv-sor, poisson, graph-cut-6, graph-cut-26, vrip, did you mean 'graph-cut-6'?");
  expect_refused({"reconstruct", "a.ply", "--outside", "sold"}, "did you mean 'solid'?");
  expect_refused({"reconstruct", "a.ply", "--settle", "of"}, "did you mean 'off'?");
  expect_refused({"scan", "knot", "-o", "x", "--orbit", "rnig"}, "did you mean 'ring'?");
  expect_refused({"render", "a.ply", "-o", "x.png", "--shading", "smoth"}, "did you mean 'smooth'?");
  expect_refused({"render", "a.ply", "-o", "x.png", "--view", "frnt"}, "did you mean 'front'?");
  expect_refused({"render", "a.ply", "-o", "x.png", "--background", "balck"}, "did you mean 'black'?");
  expect_refused({"-q", "scan", "shpere", "-o", "x"}, "did you mean 'sphere'?");
  expect_refused({"completion", "bsh"}, "did you mean 'bash'?");
}

TEST(Mistyped, AFileWithoutACommandIsReconstructed) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("a.ply")) << "ply\n";
  expect_refused({folder.file("a.ply")}, "for this file: soapfilm reconstruct " + folder.file("a.ply"));
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
